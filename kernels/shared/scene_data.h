#ifndef CLR_SCENE_DATA_H
#define CLR_SCENE_DATA_H
/* The scene as it lies in device memory. Lengths are in the renderer's own units: recentred, and
   scaled by a power of two. Colours are linear sRGB. */

#include "shared/shared_types.h"
#include "shared/table_size.h"

CLR_PRECISION_BEGIN

/* "No such index" in every uint field. */
#define CLR_NONE 0xffffffffu

/* Primitives are numbered through: first the spheres and then the planars that every ray tests,
   lane-wise; then what lies in the BVH: the triangles, its spheres, and the quadrics. */

/* A sphere; a negative radius turns its normal inwards. */
typedef struct {
    clr_real center[3];
    clr_real radius;
} Sphere;
CLR_STATIC_WORDS(Sphere, 4);

/* What a ray is tested against. Of a huge sphere (HUGE_COUNT) the first entry holds a and h, the
   second one curvature and radius, see sphere.clh. */
typedef struct {
    clr_real center[3];
    clr_real radius2;
} SphereTest;
CLR_STATIC_WORDS(SphereTest, 4);

/* A rectangle or a disk: points origin + a du + b dv, with |a|, |b| <= 1 or a^2 + b^2 <= 1.
   `ra` and `rb` are the dual vectors: a = ra . (p - origin), and `half` how far it reaches along
   the coordinate axes: |du| + |dv|, by components. These three are of the outline that rays are
   tested against, which is some units in the last place larger than the shape: so no ray passes
   between two that share an edge. `distance` is normal . origin. */
typedef struct {
    clr_real origin[3];
    clr_word is_disk;
    clr_real normal[3];
    clr_real area;
    clr_real du[3];
    clr_real half_x;
    clr_real dv[3];
    clr_real half_y;
    clr_real ra[3];
    clr_real half_z;
    clr_real rb[3];
    clr_real distance;
} Planar;
CLR_STATIC_WORDS(Planar, 24);

/* A cuboid: the points with |axis . p - middle| <= half_size for three unit vectors. What lies
   nearer to a face than `slack` lies on it. */
typedef struct {
    clr_real axis[3][3];
    clr_real middle[3];
    clr_real half_size[3];
    clr_real slack;
} Cuboid;
CLR_STATIC_WORDS(Cuboid, 16);

/* What a primitive belongs to. The materials are those of the two sides, front | back << 16;
   CLR_NO_MATERIAL reflects nothing. */
#define CLR_NO_MATERIAL 0xffffu
typedef struct {
    uint materials;
    uint emitter;
} ShapeInfo;
CLR_STATIC_SIZE(ShapeInfo, 8);

/* What a hit on a lane-wise primitive needs, in one place: a sphere's centre and radius (of a huge
   one a and h, see sphere.clh) or a planar's normal and its distance from the origin, the shape's
   info, the first half of the material of its sides, where they do not differ
   (MATERIALS_IN_RECORDS), and a planar's dual vectors: its coordinates of the point p are
   to_a . p + to_a[3] and to_b . p + to_b[3]. */
typedef struct {
    clr_real place[3]; /* centre or normal */
    clr_real size;     /* radius or distance */
    clr_word materials;
    clr_word emitter;
    clr_word is_disk;
    clr_real inv_size; /* of a sphere */
    clr_real material[8];
    clr_real to_a[4]; /* of a planar */
    clr_real to_b[4];
} PrimitiveRecord;
CLR_STATIC_WORDS(PrimitiveRecord, 24);

/* Material::kind: the kind, and flags. */
enum {
#define CLR_BSDF(KIND, kind, width, lobes, meaning) CLR_BSDF_##KIND,
#define CLR_BSDF_NODE(KIND, meaning) CLR_BSDF_##KIND,
#include "shared/bsdf_list.def"
    CLR_BSDF_KINDS
};
#define CLR_BSDF_FIRST_NODE CLR_BSDF_BLEND
#define CLR_BSDF_KIND_MASK 0xffu
#define CLR_BSDF_GGX 0x100u           /* microfacets are distributed by GGX */
#define CLR_BSDF_BECKMANN 0x200u      /* or by Beckmann */
#define CLR_BSDF_TANGENTS 0x400u      /* the frame has to follow dp/du */
#define CLR_BSDF_FLIPS_NORMALS 0x800u /* PerturbedNormals::flip_invalid */
#define CLR_BSDF_SHADOWS_NORMALS 0x1000u
#define CLR_BSDF_TRANSMITS 0x8000u     /* a lobe that is no delta lies behind the surface */
#define CLR_BSDF_NONLINEAR 0x4000u     /* plastic whose hue changes with each reflection inside */
#define CLR_BSDF_MIRRORED 0x2000u      /* shown by `twosided` on the back of the surface */
#define CLR_BSDF_LETS_THROUGH 0x10000u /* a map of what lets light through */

/* One side of a surface. `color` scales the reflection, `color2` the transmission (dielectric);
   a texture, where there is one, replaces the colour. Conductor: eta and k per channel.
   Dielectric: eta[0] is interior over exterior index, eta[1] its inverse. All other kinds have
   what they need in the pool of parameters, from number `parameters` on (bsdf_parameters.h). */
typedef struct {
    clr_real color[3];
    clr_word kind;
    clr_real color2[3];
    clr_word texture;
    clr_real eta[3];
    clr_word texture2;
    clr_real k[3];
    clr_word parameters;
} Material;
CLR_STATIC_WORDS(Material, 16);

/* From the world's axes to the own ones of a sphere, for its (u, v). */
typedef struct {
    clr_real axis[3][3];
} ShapeFrame;
CLR_STATIC_WORDS(ShapeFrame, 9);

#define CLR_LIGHT_POINT 0u
#define CLR_LIGHT_SPHERE 1u
#define CLR_LIGHT_PLANAR 2u
#define CLR_LIGHT_TRIANGLE 3u
#define CLR_LIGHT_SPOT 4u
#define CLR_LIGHT_PROJECTOR 5u
#define CLR_LIGHT_DIRECTIONAL 6u
#define CLR_LIGHT_QUADRIC 7u
#define CLR_LIGHT_SUN 8u

/* One thing that light sampling can choose. `prim` is the sphere, the planar, the quadric, or the
   entry of the light triangles or of the light beams; bit k of `trail` is the child taken at level
   k of the light tree. `position` is that of a point, spot or projector, the centre of a sphere,
   the middle of the only light, or of a directional one the unit vector towards it. Point and spot:
   radiance holds the intensity, times the square of the unit of length; projector: pi times the
   irradiance at distance 1, or pi where a texture tells it, times the same; directional: the
   irradiance; the sun: its radiance, with the rest in SkyModel. */
typedef struct {
    clr_real position[3];
    clr_word kind;
    clr_real radiance[3];
    clr_word texture;
    clr_word prim;
    clr_word trail;
    clr_real area;   /* of a planar or a triangle */
    clr_real radius; /* of a sphere */
    clr_word shape;  /* of a sphere */
    clr_word pad[3];
} Light;
CLR_STATIC_WORDS(Light, 16);

/* What a path that meets an emitter by chance needs: its radiance, and the density with which light
   sampling, once it has chosen the light, takes this point: per unit area for planars and for a
   triangle that is the only light, 1 for spheres, quadrics and the other triangles (kind says
   which), 0 where it is never sampled. Primitive `first_prim` is light `light`, and the further
   triangles of a mesh are the lights that follow. */
typedef struct {
    clr_real radiance[3];
    clr_word texture;
    clr_real density;
    clr_word kind;
    clr_word light;
    clr_word first_prim;
    clr_real center[3];
    clr_real radius;
    clr_word pad[4];
} EmitterInfo;
CLR_STATIC_WORDS(EmitterInfo, 16);

/* An emissive triangle: v0 and two edges, front side by their cross product. With vertex normals
   (`smooth`), `normals` tell the front side as they do for shading. */
typedef struct {
    clr_real v0[3];
    clr_word smooth;
    clr_real e1[3];
    clr_word triangle; /* its number among the scene's */
    clr_real e2[3];
    clr_real normals[3][3];
    clr_real uvs[3][2];
    clr_real pad1[2];
} LightTriangle;
CLR_STATIC_WORDS(LightTriangle, 28);

/* What a spot or a projector lights. For a vector w from it to a point, z = axis . w is the depth,
   and its texture is looked up at (u, v) = (1/2 + to_u . w / z, 1/2 + to_v . w / z). A spot is dark
   from the angle `cutoff` (turns) on and grows by `ramp` a turn inwards, up to its full intensity;
   `reach` is what takes (to_u . w, to_v . w) to the units of z. A projector's light goes through
   the unit square, and falls with z^2 times front . w / |w|. */
typedef struct {
    clr_real to_u[3];
    clr_real cutoff;
    clr_real to_v[3];
    clr_real ramp;
    clr_real axis[3];
    clr_real reach;
    clr_real front[3];
    clr_real pad;
} LightBeam;
CLR_STATIC_WORDS(LightBeam, 16);

/* A node of the light tree: bounds of both children. Of each: the sphere around its lights and
   their summed intensity (the largest radiant intensity in any direction, luminance); the index of
   the child's node, or CLR_LIGHT_LEAF plus the light's; and the cone that holds the normals of its
   lights, by its axis and the cosine and sine of its half angle. The fourth number of the axis is 0
   where no light leaves the cone, else 1. CLR_LIGHT_DISTANT is added to the index of children that
   are infinitely far away: their points are directions, their intensity is irradiance. */
#define CLR_LIGHT_LEAF 0x80000000u
#define CLR_LIGHT_DISTANT 0x40000000u
#define CLR_LIGHT_TREE_LEVELS 32
typedef struct {
    clr_real center[3];
    clr_real radius2;
    clr_real intensity;
    clr_word child;
    clr_real cosine;
    clr_real sine;
} LightBounds;
CLR_STATIC_WORDS(LightBounds, 8);
typedef struct {
    LightBounds bounds[2];
    clr_real axis[2][4];
} LightNode;
CLR_STATIC_WORDS(LightNode, 24);

/* A sky and its sun (sky.clh). `channels`: of red, green and blue the parameters A to I of Hosek
   and Wilkie's distribution, and what it is scaled by. The sun is the disk of half angle a around
   `to_sun`, where `cap` is 1 - cos a and `chord2` the square of the chord, above the horizon across
   `up`; it is light `light`. Directions are the world's. */
typedef struct {
    clr_real channels[3][12];
    clr_real to_sun[3];
    clr_real cap;
    clr_real up[3];
    clr_real chord2;
    clr_real sun_radiance[3];
    clr_word light;
} SkyModel;
CLR_STATIC_WORDS(SkyModel, 48);

#define CLR_TEXTURE_BITMAP_U8 0u
#define CLR_TEXTURE_BITMAP_F32 1u
#define CLR_TEXTURE_CHECKERBOARD 2u
#define CLR_TEXTURE_ATTRIBUTE 3u

#define CLR_WRAP_REPEAT 0u
#define CLR_WRAP_MIRROR 1u
#define CLR_WRAP_CLAMP 2u

/* A texture looked up at (m0 u + m1 v + m2, m3 u + m4 v + m5). `offset` counts pixels: packed RGBA
   bytes in the u8 array (through decode table `decode`, CLR_DECODE_*), or triples of floats. An
   attribute of meshes is number `offset` of the `attributes` that there are, constant over a face
   where it is `nearest`: its triple of vertex or triangle i of shape s is number
   attribute_places[s * attributes + offset] + i, modulo 2^32. A bitmap can be looked up where the
   attribute `coordinates` says, in place of (u, v). Bitmaps and attributes are multiplied with
   color0, and with the attribute `product` if there is one. A number is 1 from the cutoff
   color1[0] on, else 0, where `is_cut`. */
#define CLR_DECODE_LINEAR 0u
#define CLR_DECODE_SRGB 1u
#define CLR_DECODE_HALF 2u /* added: the same, rounded to half precision */

/* What is asked for of a bitmap: its colour, or a number, which is its luminance or a channel. */
#define CLR_TEXEL_COLOR 0u
#define CLR_TEXEL_LUMINANCE 1u
#define CLR_TEXEL_RED 2u
#define CLR_TEXEL_GREEN 3u
#define CLR_TEXEL_BLUE 4u

typedef struct {
    clr_real to_uv[6];
    uint kind;
    uint wrap; /* along u */
    uint width;
    uint height;
    uint offset;
    uint nearest;
    clr_real color0[3];
    uint decode;
    clr_real color1[3];
    uint number; /* CLR_TEXEL_* */
    uint wrap_v; /* along v */
    uint is_cut;
    uint coordinates, product, attributes;
    uint unused;
} TextureInfo;
CLR_STATIC_SIZE(TextureInfo, CLR_EITHER(104, 160));

CLR_PRECISION_END
#endif
