#ifndef CLR_SHARED_SPECULAR_CONNECTOR_H
#define CLR_SHARED_SPECULAR_CONNECTOR_H
/* The ways that light sampling can take over one mirror or through one ball of glass, see
   specular_connection.clh. */

#include "shared/shared_types.h"

CLR_PRECISION_BEGIN

/* SpecularConnector::kind. */
#define CLR_CONNECT_REFLECTION 0u /* off the outside of a sphere */
#define CLR_CONNECT_REFRACTION 1u /* into a sphere and out of it */
#define CLR_CONNECT_PLANE 2u      /* off a plane */

/* A specular surface and a light. The surface is primitive `prim`; `place` and `size` are a
   sphere's centre and radius, or a plane's normal on the side that reflects and its distance from
   the origin. `toward` is the unit vector from the centre to the middle of the light, or that
   middle mirrored in the plane. The chain leaves `color` of the radiance, times Fresnel's factors:
   of a dielectric where inv_eta is not 0, of the conductor `material` where that is not CLR_NONE.
   `weight` is what the choice among the connectors goes by, see specular_connector_weight(). */
typedef struct {
    clr_real place[3];
    clr_real size;
    clr_real toward[3];
    clr_real weight;
    clr_real color[3];
    clr_real inv_eta;
    clr_word prim;
    clr_word kind;
    clr_word light;
    clr_word material;
} SpecularConnector;
CLR_STATIC_WORDS(SpecularConnector, 16);

CLR_PRECISION_END
#endif
