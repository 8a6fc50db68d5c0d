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

/* Two that follow each other, which are fetched at once. */
typedef struct {
    BsdfParameter first, second;
} BsdfParameterPair;
CLR_STATIC_WORDS(BsdfParameterPair, 8);

/* What both have first whose microfacets may be anisotropic: rough conductors and dielectrics. */
enum { CLR_MICROFACETS_ALPHA_U, CLR_MICROFACETS_ALPHA_V, CLR_MICROFACETS_PARAMETERS };

enum {
    CLR_ROUGHCONDUCTOR_REFLECTANCE = CLR_MICROFACETS_PARAMETERS,
    CLR_ROUGHCONDUCTOR_ETA,
    CLR_ROUGHCONDUCTOR_K,
    CLR_ROUGHCONDUCTOR_PARAMETERS
};

enum {
    CLR_ROUGHDIELECTRIC_REFLECTANCE = CLR_MICROFACETS_PARAMETERS,
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

/* Of plastic; rough plastic has a boundary as well. */
enum {
    CLR_PLASTIC_DIFFUSE,
    CLR_PLASTIC_SPECULAR,
    CLR_PLASTIC_ETA, /* interior over exterior, its inverse, reflectance from inside */
    CLR_PLASTIC_PARAMETERS,
    CLR_ROUGHPLASTIC_BOUNDARY = CLR_PLASTIC_PARAMETERS, /* alpha, start in the tables */
    CLR_ROUGHPLASTIC_PARAMETERS
};
/* A table of what a rough boundary lets pass has so many cosines, from 0 to 1. */
#define CLR_BOUNDARY_COSINES 64

enum {
    CLR_PRINCIPLED_BASE_COLOR,
    CLR_PRINCIPLED_ROUGHNESS,
    CLR_PRINCIPLED_ANISOTROPIC,
    CLR_PRINCIPLED_METALLIC,
    CLR_PRINCIPLED_SPEC_TRANS,
    CLR_PRINCIPLED_ETA, /* interior over exterior, and its inverse */
    CLR_PRINCIPLED_SPEC_TINT,
    CLR_PRINCIPLED_SHEEN,
    CLR_PRINCIPLED_SHEEN_TINT,
    CLR_PRINCIPLED_FLATNESS,
    CLR_PRINCIPLED_CLEARCOAT,
    CLR_PRINCIPLED_CLEARCOAT_GLOSS,
    CLR_PRINCIPLED_PARAMETERS
};

enum {
    CLR_PRINCIPLEDTHIN_BASE_COLOR,
    CLR_PRINCIPLEDTHIN_ROUGHNESS,
    CLR_PRINCIPLEDTHIN_ANISOTROPIC,
    CLR_PRINCIPLEDTHIN_SPEC_TRANS,
    CLR_PRINCIPLEDTHIN_ETA, /* interior over exterior */
    CLR_PRINCIPLEDTHIN_SPEC_TINT,
    CLR_PRINCIPLEDTHIN_SHEEN,
    CLR_PRINCIPLEDTHIN_SHEEN_TINT,
    CLR_PRINCIPLEDTHIN_FLATNESS,
    CLR_PRINCIPLEDTHIN_DIFF_TRANS, /* 0 to 2 */
    CLR_PRINCIPLEDTHIN_PARAMETERS
};

/* Nodes of trees. The value is the share of the second child (blend), the normal as a colour
   (normalmap) or the height (bumpmap); `children` holds the materials of both children and the
   scale of the height. */
enum { CLR_NODE_VALUE, CLR_NODE_CHILDREN, CLR_NODE_PARAMETERS };

/* The most that any kind has. */
#define CLR_MOST_BSDF_PARAMETERS 12

CLR_PRECISION_END
#endif
