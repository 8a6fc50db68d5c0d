/// tinygltf's implementation.

#include <fstream> // tinygltf names it without including it

#define TINYGLTF_IMPLEMENTATION
#include "gltf_tiny.h"
