#include "bsdf_packing.h"

#include <algorithm>

namespace clrender::inline CLR_PRECISION {

namespace {

/// Where all dielectrics have the same tint, or the same index, every material gets it, and the
/// kernel need not ask which one it has hit.
void share_dielectric_fields(FlatScene &flat) {
    const auto is_dielectric = [](const Material &m) { return m.kind == CLR_BSDF_DIELECTRIC; };
    const auto first = std::find_if(flat.materials.begin(), flat.materials.end(), is_dielectric);
    if (first == flat.materials.end())
        return;
    const Material model = *first;
    const int shades = dielectric_shades(flat.materials);
    for (Material &m : flat.materials) {
        if ((shades & CLR_SHADES_TINTS) == 0)
            std::copy_n(model.color2, 3, m.color2);
        if ((shades & CLR_SHADES_INDICES) == 0 && m.kind != CLR_BSDF_CONDUCTOR)
            std::copy_n(model.eta, 3, m.eta);
    }
}

/// Whether the sides are those of nested BSDFs.
bool nests_bsdfs(const BsdfModel &model) {
    return std::holds_alternative<MaskBsdf>(model) || std::holds_alternative<BlendBsdf>(model) ||
           std::holds_alternative<NormalMapBsdf>(model) ||
           std::holds_alternative<BumpMapBsdf>(model);
}

/// Lays the parameters of all materials out in the pool, as many for each.
void fill_parameter_pool(const std::vector<PackedBsdf> &packed, Flattening &work) {
    FlatScene &flat = work.flat;
    std::size_t most = 0;
    for (const PackedBsdf &bsdf : packed)
        most = std::max(most, bsdf.parameters.size());
    // A forced feature needs room for the parameters of every kind. Records of the device hold two
    // parameters each.
    if (work.wants("BSDF_PARAMETERS"))
        most = CLR_MOST_BSDF_PARAMETERS;
    most += most % 2;
    for (std::size_t i = 0; i < packed.size(); ++i) {
        std::vector<BsdfParameter> parameters = packed[i].parameters;
        parameters.resize(most, {{0, 0, 0}, CLR_NONE});
        flat.materials[i].parameters = static_cast<uint>(flat.bsdf_parameters.size());
        flat.bsdf_parameters.insert(flat.bsdf_parameters.end(), parameters.begin(),
                                    parameters.end());
    }
}

} // namespace

int dielectric_shades(const std::vector<Material> &materials) {
    const Material *model = nullptr;
    int shades = 0;
    for (const Material &m : materials) {
        if (m.kind != CLR_BSDF_DIELECTRIC)
            continue;
        if (model == nullptr)
            model = &m;
        if (!std::equal(m.color2, m.color2 + 3, model->color2))
            shades |= CLR_SHADES_TINTS;
        if (m.eta[0] != model->eta[0])
            shades |= CLR_SHADES_INDICES;
    }
    return shades;
}

uint MaterialPacker::material_of(int bsdf, BsdfSide side) {
    if (bsdf == none)
        return CLR_NO_MATERIAL;
    const BsdfModel &model = work.scene.bsdfs[static_cast<std::size_t>(bsdf)].model;
    if (const auto *twosided = std::get_if<TwosidedBsdf>(&model))
        return material_of(side.back ? twosided->back : twosided->front,
                           {false, side.mirrored || side.back});
    const bool nests = nests_bsdfs(model);
    if (side.back && !nests && !lets_light_through(work.scene, bsdf))
        return CLR_NO_MATERIAL;
    // Leaves look at the frame alone, so that all sides share one material.
    const BsdfSide key = nests ? side : BsdfSide{};
    const auto [known, is_new] = index_.emplace(std::tuple(bsdf, key.back, key.mirrored), 0);
    if (!is_new)
        return known->second;
    PackedBsdf result = std::visit([&](const auto &m) { return pack_bsdf(*this, m, key); }, model);
    return index_[std::tuple(bsdf, key.back, key.mirrored)] = append(std::move(result));
}

uint MaterialPacker::material_of(const NullBsdf &null) {
    if (null_ == CLR_NO_MATERIAL)
        null_ = append(pack_bsdf(*this, null, {}));
    return null_;
}

uint MaterialPacker::append(PackedBsdf result) {
    work.flat.materials.push_back(result.material);
    packed.push_back(std::move(result));
    return static_cast<uint>(packed.size() - 1);
}

BsdfParameter MaterialPacker::colour(int texture, const Rgb &absent) {
    BsdfParameter p{};
    p.texture = flatten_texture(work, texture, absent, p.value);
    return p;
}

BsdfParameter MaterialPacker::children(uint first, uint second) {
    return {{static_cast<clr_real>(first), static_cast<clr_real>(second), 0}, CLR_NONE};
}

BsdfParameter MaterialPacker::eta(const IndicesOfRefraction &ior) {
    BsdfParameter p{{0, 0, 0}, CLR_NONE};
    store(p.value, Rgb{ior.interior / ior.exterior, ior.exterior / ior.interior, 0});
    return p;
}

void flatten_materials(Flattening &work) {
    FlatScene &flat = work.flat;
    MaterialPacker packer(work);
    // Only BSDFs that some shape shows are flattened; equal sides share one material.
    const auto take = [&](const Shape &shape) {
        const uint front = packer.material_of(shape.bsdf, {false, false});
        const uint back = packer.material_of(shape.bsdf, {true, false});
        if (flat.materials.size() >= CLR_NO_MATERIAL)
            throw InputError(shape.where, "more than 65534 different BSDFs are not supported");
        work.sides_of_bsdf[shape.bsdf] = front | back << 16;
    };
    for (const Shape &shape : work.scene.shapes)
        take(shape);
    for (const ShapeGroup &group : work.scene.groups)
        for (const Shape &shape : group.shapes)
            take(shape);
    fill_parameter_pool(packer.packed, work);
    share_dielectric_fields(flat);
}

} // namespace clrender::inline CLR_PRECISION
