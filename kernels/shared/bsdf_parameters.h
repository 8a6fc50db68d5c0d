#ifndef CLR_BSDF_PARAMETERS_H
#define CLR_BSDF_PARAMETERS_H
/* What the pool of parameters holds of each kind of BSDF: its parameters in this order, all of them
   colours, or numbers in their first component. */

#include "shared/shared_types.h"

CLR_PRECISION_BEGIN

/* A parameter: its value, which a texture replaces unless it is CLR_NONE. */
typedef struct {
    clr_real value[3];
    clr_word texture;
} BsdfParameter;
CLR_STATIC_WORDS(BsdfParameter, 4);

enum {
    CLR_ROUGHCONDUCTOR_ALPHA_U,
    CLR_ROUGHCONDUCTOR_ALPHA_V,
    CLR_ROUGHCONDUCTOR_REFLECTANCE,
    CLR_ROUGHCONDUCTOR_ETA,
    CLR_ROUGHCONDUCTOR_K,
    CLR_ROUGHCONDUCTOR_PARAMETERS
};

enum {
    CLR_ROUGHDIELECTRIC_ALPHA_U,
    CLR_ROUGHDIELECTRIC_ALPHA_V,
    CLR_ROUGHDIELECTRIC_REFLECTANCE,
    CLR_ROUGHDIELECTRIC_TRANSMITTANCE,
    CLR_ROUGHDIELECTRIC_ETA, /* interior over exterior, and its inverse */
    CLR_ROUGHDIELECTRIC_PARAMETERS
};

enum {
    CLR_THINDIELECTRIC_REFLECTANCE,
    CLR_THINDIELECTRIC_TRANSMITTANCE,
    CLR_THINDIELECTRIC_ETA, /* interior over exterior, and its inverse */
    CLR_THINDIELECTRIC_PARAMETERS
};

/* Nodes of trees. The value is the share of the second child (blend), the normal as a colour
   (normalmap) or the height (bumpmap); `children` holds the materials of both children and the
   scale of the height. */
enum { CLR_NODE_VALUE, CLR_NODE_CHILDREN, CLR_NODE_PARAMETERS };

/* The most that any kind has. */
#define CLR_MOST_BSDF_PARAMETERS 6

CLR_PRECISION_END
#endif
