/// The implementations of stb_image (PNG, JPEG, TGA, BMP) and stb_image_write, in one place.

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#include "stb_memory.h"

#define STB_IMAGE_IMPLEMENTATION
#define STBI_MALLOC(size) clrender_stb_malloc(size)
#define STBI_REALLOC(block, size) clrender_stb_realloc(block, size)
#define STBI_FREE(block) clrender_stb_free(block)
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_ONLY_TGA
#define STBI_ONLY_BMP
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS (1 << 28)
#include <stb/stb_image.h>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>
