#!/usr/bin/env python3
"""Writes bsdf_values.csv: values times cosine of Mitsuba 3's rough BSDFs for random parameters and
directions. A line: material, its parameters (order below), wi, wo, value.

Not needed to run the tests. Install with `pip install mitsuba numpy`."""

import pathlib

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")

SETS, DIRECTIONS = 12, 5


def rgb(values):
    return {"type": "rgb", "value": [float(v) for v in values]}


def texture(values):
    """A colour that need not stay below 1."""
    return {"type": "rgb", "value": [float(v) for v in values]}


def microfacets(p):
    return {"distribution": "beckmann" if p[0] else "ggx", "alpha_u": p[1], "alpha_v": p[2]}


def roughconductor(p):
    return {**microfacets(p), "eta": texture(p[3:6]), "k": texture(p[6:9]),
            "specular_reflectance": rgb(p[9:12])}


def roughdielectric(p):
    return {**microfacets(p), "int_ior": p[3], "ext_ior": 1.0, "specular_reflectance": rgb(p[4:7]),
            "specular_transmittance": rgb(p[7:10])}


def plastic(p):
    return {"diffuse_reflectance": rgb(p[0:3]), "specular_reflectance": rgb(p[3:6]),
            "int_ior": p[6], "ext_ior": 1.0, "nonlinear": bool(p[7])}


def roughplastic(p):
    return {"distribution": "beckmann" if p[0] else "ggx", "alpha": p[1], **plastic(p[2:])}


PRINCIPLED = ("roughness anisotropic metallic spec_trans eta spec_tint sheen sheen_tint flatness "
              "clearcoat clearcoat_gloss").split()
THIN = "roughness anisotropic spec_trans eta spec_tint sheen sheen_tint flatness diff_trans".split()


def principled(p):
    return {"base_color": rgb(p[0:3]), **dict(zip(PRINCIPLED, p[3:]))}


def principledthin(p):
    return {"base_color": rgb(p[0:3]), **dict(zip(THIN, p[3:]))}


def draw(name, rng, i):
    """Random parameters; every third set leaves most of the optional ones at 0."""
    u = lambda n: list(np.round(rng.uniform(0.02, 0.98, n), 3))
    alpha = lambda: round(float(np.exp(rng.uniform(np.log(0.05), 0))), 3)
    eta = round(float(rng.choice([0.4, 0.7, 1.2, 1.33, 1.5, 2.4])), 3)
    ggx = [i % 2]
    if name == "roughconductor":
        return ggx + [alpha(), alpha()] + list(np.round(rng.uniform(0.1, 4, 6), 3)) + u(3)
    if name == "roughdielectric":
        return ggx + [alpha(), alpha(), eta] + u(6)
    if name == "plastic":
        return u(6) + [max(eta, 1.2), i // 2 % 2]
    if name == "roughplastic":
        return ggx + [alpha()] + u(6) + [max(eta, 1.2), i // 2 % 2]
    sparse = (lambda n: list(np.round(rng.uniform(0, 1, n) * (rng.uniform(0, 1, n) < 0.3), 3))) \
        if i % 3 == 0 else u
    if name == "principled":
        return u(3) + [max(u(1)[0], 0.1)] + sparse(3) + [eta] + sparse(6)
    return u(3) + [max(u(1)[0], 0.1)] + sparse(2) + [max(eta, 0.7)] + sparse(4) + \
        [round(2 * v, 3) for v in sparse(1)]


def direction(rng, side):
    z = rng.uniform(0.05, 1)
    phi = rng.uniform(0, 2 * np.pi)
    s = np.sqrt(1 - z * z)
    return np.float32([s * np.cos(phi), s * np.sin(phi), side * z])


def main():
    rng = np.random.default_rng(13)
    lines = []
    for make in (roughconductor, roughdielectric, plastic, roughplastic, principled, principledthin):
        two_sided = make in (roughdielectric, principled, principledthin)
        for i in range(SETS):
            parameters = [float(v) for v in draw(make.__name__, rng, i)]
            bsdf = mi.load_dict({"type": make.__name__, **make(parameters)})
            for k in range(DIRECTIONS):
                wi = direction(rng, -1 if two_sided and k % 2 else 1)
                wo = direction(rng, -1 if two_sided and k // 2 % 2 else 1)
                # Close to the mirror's direction for half of them, where lobes are.
                if k % 2 == 0 or not two_sided:
                    wo = np.float32(wo * [.3, .3, 1] - wi * [1, 1, 0])
                    wo = np.float32(wo / np.linalg.norm(wo))
                si = mi.SurfaceInteraction3f()
                si.wi = [float(v) for v in wi]
                value = np.array(bsdf.eval(mi.BSDFContext(), si, [float(v) for v in wo]))
                numbers = [*parameters, *wi, *wo, *value]
                lines.append(",".join([make.__name__] + [f"{float(v):.7g}" for v in numbers]))
    (pathlib.Path(__file__).parent / "bsdf_values.csv").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
