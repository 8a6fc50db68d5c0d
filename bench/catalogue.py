"""The benchmark's scenes: names and titles."""

TITLES = {
    "room": "The report's room",
    "mesh": "A mesh in a box, small lamp",
    "sky": "Painted meshes, sky with a sun",
    "glass": "Mirror and glass in a box",
    "lights": "400 sphere lights, 50 meshes",
    "million": "A million triangles, sky and lamp",
    "spheres": "Ten thousand spheres",
    "herd": "4,096 instances of a mesh, sky",
}
