#include "io/shim/gltf.h"

#include <algorithm>
#include <array>
#include <deque>
#include <fstream>
#include <memory>
#include <new>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_INCLUDE_JSON
#define TINYGLTF_NO_FS
#include <tiny_gltf.h>

extern "C" {
#include "base/error.h"
}

using nlohmann::json;

namespace
{

/* Where a mesh says which of its vertices are one: Khronos' vendor extension, and for surfaces that it does not admit
 * the same object in the mesh's extras. */
const char *const manifold_extension = "EXT_mesh_manifold";
const char *const own_topology = "hewn_topology";

/* The first line of a library's message. */
std::string first_line(const std::string &text)
{
    return text.substr(0, text.find('\n'));
}

/* Text that JSON can hold: bytes that are no UTF-8 become U+FFFD. */
std::string as_utf8(const char *text)
{
    return json::parse(json(text).dump(-1, ' ', false, json::error_handler_t::replace)).get<std::string>();
}

/* --- making ------------------------------------------------------------------------------------------------------- */

/* Appends a view and returns its number. */
int add_view(tinygltf::Model &model, size_t &offset, size_t length, int target)
{
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = offset;
    view.byteLength = length;
    view.target = target;
    offset += length;
    model.bufferViews.push_back(view);
    return static_cast<int>(model.bufferViews.size()) - 1;
}

/* Appends an accessor and returns its number. */
int add_accessor(tinygltf::Model &model, int view, size_t offset, uint64_t count, int type, int component)
{
    tinygltf::Accessor accessor;
    accessor.bufferView = view;
    accessor.byteOffset = offset;
    accessor.componentType = component;
    accessor.count = static_cast<size_t>(count);
    accessor.type = type;
    model.accessors.push_back(accessor);
    return static_cast<int>(model.accessors.size()) - 1;
}

int vector_type(int components)
{
    switch (components) {
    case 1: return TINYGLTF_TYPE_SCALAR;
    case 2: return TINYGLTF_TYPE_VEC2;
    case 3: return TINYGLTF_TYPE_VEC3;
    case 4: return TINYGLTF_TYPE_VEC4;
    case 9: return TINYGLTF_TYPE_MAT3;
    case 16: return TINYGLTF_TYPE_MAT4;
    default: throw std::logic_error("a number of components that glTF has no type for");
    }
}

/* Views and accessors of everything that belongs to vertices. */
void add_streams(tinygltf::Model &model, size_t &length, const hewn_gltf_desc &desc, tinygltf::Primitive &primitive)
{
    size_t count = static_cast<size_t>(desc.vertex_count);
    int positions = add_accessor(model, add_view(model, length, 12 * count, TINYGLTF_TARGET_ARRAY_BUFFER), 0, count,
                                 TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT);
    model.accessors[positions].minValues.assign(desc.lo, desc.lo + 3);
    model.accessors[positions].maxValues.assign(desc.hi, desc.hi + 3);
    primitive.attributes["POSITION"] = positions;
    for (size_t i = 0; i < desc.stream_count; i++) {
        const hewn_gltf_stream &stream = desc.streams[i];
        int view = add_view(model, length, count * stream.item, TINYGLTF_TARGET_ARRAY_BUFFER);
        if (stream.component_type != TINYGLTF_COMPONENT_TYPE_FLOAT)
            model.bufferViews[view].byteStride = stream.item; /* the items may be padded */
        int accessor = add_accessor(model, view, 0, count, vector_type(stream.components), stream.component_type);
        model.accessors[accessor].normalized = stream.normalised;
        primitive.attributes[as_utf8(stream.semantic)] = accessor;
    }
}

/* What tinygltf's types have no place for, and goes to the JSON itself. */
struct additions {
    std::optional<json> sparse;   /* of the accessor that has merges */
    size_t sparse_accessor = 0;   /* its number */
    std::optional<json> topology; /* EXT_mesh_manifold's object */
};

/* The unsplit vertices' indices: those of the primitives, but for the places of merges. */
void add_topology(tinygltf::Model &model, size_t &length, const hewn_gltf_desc &desc, int index_view,
                  const tinygltf::Primitive &primitive, additions &out)
{
    int type = desc.short_indices ? TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT : TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    int indices = add_accessor(model, index_view, 0, desc.index_count, TINYGLTF_TYPE_SCALAR, type);
    json &topology = out.topology.emplace();
    topology["manifoldPrimitive"] = {
        {"indices", indices}, {"mode", 4}, {"attributes", {{"POSITION", primitive.attributes.at("POSITION")}}}};
    if (desc.merge_count == 0)
        return;
    length = (length + 3) & ~size_t(3);
    size_t count = static_cast<size_t>(desc.merge_count);
    int places = add_view(model, length, 4 * count, 0);
    int vertices = add_view(model, length, (desc.short_indices ? 2 : 4) * count, 0);
    out.sparse_accessor = static_cast<size_t>(indices);
    out.sparse = json{{"count", count},
                      {"indices", {{"bufferView", places}, {"componentType", TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT}}},
                      {"values", {{"bufferView", vertices}}}};
    topology["mergeIndices"] =
        add_accessor(model, places, 0, count, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
    topology["mergeValues"] = add_accessor(model, vertices, 0, count, TINYGLTF_TYPE_SCALAR, type);
}

/* The mesh of `desc`; returns the length of its buffer. */
size_t add_mesh(tinygltf::Model &model, const hewn_gltf_desc &desc, const std::string &name, additions &out)
{
    size_t length = 0, item = desc.short_indices ? 2 : 4;
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    add_streams(model, length, desc, primitive);
    int view =
        add_view(model, length, static_cast<size_t>(desc.index_count) * item, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    tinygltf::Mesh mesh;
    mesh.name = name;
    int material = 0;
    for (size_t i = 0; i < desc.run_count; i++) {
        const hewn_gltf_run &run = desc.runs[i];
        primitive.indices = add_accessor(
            model, view, static_cast<size_t>(run.first_index) * item, run.index_count, TINYGLTF_TYPE_SCALAR,
            desc.short_indices ? TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT : TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
        primitive.material = run.material ? material++ : -1;
        mesh.primitives.push_back(primitive);
    }
    if (desc.topology != HEWN_GLTF_NO_TOPOLOGY)
        add_topology(model, length, desc, view, primitive, out);
    model.meshes.push_back(mesh);
    return length;
}

/* Puts into the document what stands beside tinygltf's part of it. */
void complete(json &document, const hewn_gltf_desc &desc, size_t length, additions &more)
{
    if (length > 0)
        document["buffers"] = json::array({{{"byteLength", length}}});
    for (size_t i = 0; length > 0 && i < desc.run_count; i++)
        if (desc.runs[i].material)
            document["materials"].push_back({{"name", as_utf8(desc.runs[i].material)}});
    if (more.sparse)
        document["accessors"][more.sparse_accessor]["sparse"] = std::move(*more.sparse);
    if (more.topology && desc.topology == HEWN_GLTF_MANIFOLD) {
        document["extensionsUsed"] = json::array({manifold_extension});
        document["meshes"][0]["extensions"][manifold_extension] = std::move(*more.topology);
    } else if (more.topology) {
        document["meshes"][0]["extras"][own_topology] = std::move(*more.topology);
    }
    if (desc.conversion)
        document["asset"]["extras"]["conversion"] = json::parse(desc.conversion);
    if (desc.space)
        document["asset"]["extras"]["space"] = desc.space;
}

/* tinygltf wants to own a buffer's bytes; here they are streamed later, so only their number is added to its JSON. */
std::string compose(const hewn_gltf_desc &desc)
{
    tinygltf::Model model;
    model.asset.version = "2.0";
    model.asset.generator = desc.generator;
    std::string name = as_utf8(desc.name);
    tinygltf::Scene scene;
    scene.name = name;
    size_t length = 0;
    additions more;
    if (desc.index_count > 0) {
        length = add_mesh(model, desc, name, more);
        tinygltf::Node node;
        node.name = name;
        node.mesh = 0;
        model.nodes.push_back(node);
        scene.nodes.push_back(0);
    }
    model.scenes.push_back(scene);
    model.defaultScene = 0;
    std::ostringstream text;
    tinygltf::TinyGLTF writer;
    writer.WriteGltfSceneToStream(&model, text, false, false);
    json document = json::parse(text.str());
    complete(document, desc, length, more);
    return document.dump();
}

/* --- reading ------------------------------------------------------------------------------------------------------ */

struct bad_gltf {
    hewn_result code;
    std::string message;
};

constexpr size_t most_items = size_t(1) << 20;

/* Copies of what Hewn reads, so that nothing else (images, extras of any depth) reaches tinygltf. Only scalars are
 * copied, never a nested value of unknown depth. */
void keep_scalar(const json &from, json &to, const char *key)
{
    auto found = from.find(key);
    if (found != from.end() && !found->is_structured())
        to[key] = *found;
}

void keep_scalars(const json &from, json &to, const char *key)
{
    auto found = from.find(key);
    if (found == from.end() || !found->is_array())
        return;
    json &list = to[key] = json::array();
    for (const json &item : *found) {
        if (item.is_structured())
            throw bad_gltf{HEWN_BAD_INPUT, std::string("\"") + key + "\" holds something that is not a number"};
        list.push_back(item);
    }
}

json keep_primitive(const json &from)
{
    json to = json::object();
    for (const char *key : {"mode", "indices", "material"})
        keep_scalar(from, to, key);
    json &attributes = to["attributes"] = json::object();
    auto found = from.find("attributes");
    if (found == from.end() || !found->is_object())
        return to;
    for (const char *key : {"POSITION", "NORMAL", "TEXCOORD_0", "COLOR_0"})
        keep_scalar(*found, attributes, key);
    for (auto item = found->begin(); item != found->end(); ++item)
        if (item.key().rfind('_', 0) == 0)
            keep_scalar(*found, attributes, item.key().c_str());
    return to;
}

json keep_mesh(const json &from)
{
    json to = json::object();
    keep_scalar(from, to, "name");
    json &primitives = to["primitives"] = json::array();
    auto found = from.find("primitives");
    if (found == from.end() || !found->is_array())
        throw bad_gltf{HEWN_BAD_INPUT, "a mesh without an array of primitives"};
    for (const json &primitive : *found) {
        if (!primitive.is_object())
            throw bad_gltf{HEWN_BAD_INPUT, "a primitive is not an object"};
        primitives.push_back(keep_primitive(primitive));
    }
    return to;
}

json keep_node(const json &from)
{
    json to = json::object();
    keep_scalar(from, to, "name");
    keep_scalar(from, to, "mesh");
    for (const char *key : {"children", "matrix", "translation", "rotation", "scale"})
        keep_scalars(from, to, key);
    return to;
}

json keep_accessor(const json &from)
{
    json to = json::object();
    for (const char *key : {"bufferView", "byteOffset", "componentType", "count", "type", "normalized"})
        keep_scalar(from, to, key);
    return to;
}

json keep_view(const json &from)
{
    json to = json::object();
    for (const char *key : {"buffer", "byteOffset", "byteLength", "byteStride"})
        keep_scalar(from, to, key);
    return to;
}

json keep_material(const json &from)
{
    json to = json::object();
    keep_scalar(from, to, "name");
    return to;
}

json keep_scene(const json &from)
{
    json to = json::object();
    keep_scalars(from, to, "nodes");
    return to;
}

void keep_all(const json &from, json &to, const char *key, json (*keep)(const json &))
{
    auto found = from.find(key);
    if (found == from.end())
        return;
    if (!found->is_array())
        throw bad_gltf{HEWN_BAD_INPUT, std::string("\"") + key + "\" is not an array"};
    if (found->size() > most_items)
        throw bad_gltf{HEWN_LIMIT, std::string("more than 1048576 ") + key};
    json &list = to[key] = json::array();
    for (const json &item : *found) {
        if (!item.is_object())
            throw bad_gltf{HEWN_BAD_INPUT, std::string("\"") + key + "\" holds something that is not an object"};
        list.push_back(keep(item));
    }
}

/* Extensions that are known, and those that leave geometry alone, may be required. */
void check_extensions(const json &document)
{
    auto found = document.find("extensionsRequired");
    if (found == document.end() || !found->is_array())
        return;
    for (const json &item : *found) {
        std::string name = item.is_string() ? item.get<std::string>() : "?";
        bool harmless = name == "KHR_mesh_quantization" || name == manifold_extension;
        for (const char *prefix : {"KHR_materials_", "KHR_texture_", "KHR_lights_", "EXT_texture_", "MSFT_texture_"})
            harmless = harmless || name.rfind(prefix, 0) == 0;
        if (!harmless)
            throw bad_gltf{HEWN_BAD_INPUT, "needs the extension " + as_utf8(name.c_str()) + ", which is not supported"};
    }
}

/* The parts of hewn_gltf, and the memory behind its pointers. */
struct parsed {
    std::deque<std::string> texts; /* which stay where they are */
    std::vector<hewn_gltf_buffer> buffers;
    std::vector<hewn_gltf_view> views;
    std::vector<hewn_gltf_accessor> accessors;
    std::vector<hewn_gltf_attribute> attributes;
    std::vector<hewn_gltf_primitive> primitives;
    std::vector<hewn_gltf_mesh> meshes;
    std::vector<hewn_gltf_node> nodes;
    std::vector<int> children, roots;
    std::vector<const char *> materials;
    std::vector<std::array<float, 4>> colors;

    const char *keep(const std::string &text)
    {
        texts.push_back(text);
        return texts.back().c_str();
    }
};

/* Buffers are read here and not by tinygltf, which would copy the binary chunk once for each. */
void take_buffers(const json &document, parsed &out)
{
    auto found = document.find("buffers");
    if (found == document.end())
        return;
    if (!found->is_array() || found->size() > most_items)
        throw bad_gltf{HEWN_BAD_INPUT, "\"buffers\" is not an array of usable length"};
    for (const json &item : *found) {
        auto length = item.is_object() ? item.find("byteLength") : item.end();
        if (!item.is_object() || length == item.end() || !length->is_number_unsigned())
            throw bad_gltf{HEWN_BAD_INPUT, "a buffer without a byteLength"};
        auto uri = item.find("uri");
        bool named = uri != item.end() && uri->is_string();
        out.buffers.push_back({named ? out.keep(uri->get<std::string>()) : nullptr, length->get<uint64_t>()});
    }
}

/* One a material; what is not four numbers is white. */
void take_base_colors(const json &document, parsed &out)
{
    out.colors.assign(out.materials.size(), {1, 1, 1, 1});
    auto materials = document.find("materials");
    for (size_t i = 0; i < out.colors.size() && materials != document.end() && i < materials->size(); i++) {
        const json &material = (*materials)[i];
        auto model = material.is_object() ? material.find("pbrMetallicRoughness") : material.end();
        if (!material.is_object() || model == material.end() || !model->is_object())
            continue;
        auto factor = model->find("baseColorFactor");
        bool usable = factor != model->end() && factor->is_array() && factor->size() == 4;
        for (size_t k = 0; usable && k < 4; k++)
            usable = (*factor)[k].is_number();
        for (size_t k = 0; usable && k < 4; k++)
            out.colors[i][k] = static_cast<float>(std::min(std::max((*factor)[k].get<double>(), 0.0), 1.0));
    }
}

/* `matrix`, or translation × rotation × scale (a unit quaternion x, y, z, w), column-major. */
void compose_matrix(const tinygltf::Node &node, double m[16])
{
    if (node.matrix.size() == 16) {
        std::copy(node.matrix.begin(), node.matrix.end(), m);
        return;
    }
    bool turned = node.rotation.size() == 4, scaled = node.scale.size() == 3, moved = node.translation.size() == 3;
    double x = turned ? node.rotation[0] : 0, y = turned ? node.rotation[1] : 0;
    double z = turned ? node.rotation[2] : 0, w = turned ? node.rotation[3] : 1;
    const double turn[9] = {1 - 2 * (y * y + z * z), 2 * (x * y + z * w),     2 * (x * z - y * w),
                            2 * (x * y - z * w),     1 - 2 * (x * x + z * z), 2 * (y * z + x * w),
                            2 * (x * z + y * w),     2 * (y * z - x * w),     1 - 2 * (x * x + y * y)};
    for (int column = 0; column < 3; column++) {
        for (int row = 0; row < 3; row++)
            m[4 * column + row] = turn[3 * column + row] * (scaled ? node.scale[column] : 1);
        m[4 * column + 3] = 0;
        m[12 + column] = moved ? node.translation[column] : 0;
    }
    m[15] = 1;
}

void take_primitive(const tinygltf::Primitive &primitive, parsed &out)
{
    hewn_gltf_primitive taken{primitive.mode,     HEWN_GLTF_NONE,        primitive.indices,
                              primitive.material, out.attributes.size(), 0};
    for (const auto &attribute : primitive.attributes) {
        if (attribute.first == "POSITION")
            taken.positions = attribute.second;
        else
            out.attributes.push_back({out.keep(attribute.first), attribute.second});
    }
    taken.attribute_count = out.attributes.size() - taken.first_attribute;
    out.primitives.push_back(taken);
}

/* The scene that the document names or else its first; without scenes, all nodes that no other has. */
void take_roots(const tinygltf::Model &model, parsed &out)
{
    size_t shown = model.defaultScene >= 0 ? static_cast<size_t>(model.defaultScene) : 0;
    if (shown < model.scenes.size()) {
        out.roots = model.scenes[shown].nodes;
        return;
    }
    std::vector<bool> has_parent(out.nodes.size());
    for (int child : out.children)
        if (child >= 0 && static_cast<size_t>(child) < has_parent.size())
            has_parent[static_cast<size_t>(child)] = true;
    for (size_t node = 0; node < has_parent.size(); node++)
        if (!has_parent[node])
            out.roots.push_back(static_cast<int>(node));
}

void take_model(const tinygltf::Model &model, parsed &out)
{
    for (const auto &view : model.bufferViews)
        out.views.push_back({view.buffer, view.byteOffset, view.byteLength, view.byteStride});
    for (const auto &accessor : model.accessors) {
        int components = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type));
        bool matrix = accessor.type >= TINYGLTF_TYPE_MAT2 && accessor.type <= TINYGLTF_TYPE_MAT4;
        out.accessors.push_back({accessor.bufferView,
                                 accessor.byteOffset,
                                 accessor.count,
                                 accessor.componentType,
                                 components,
                                 matrix,
                                 accessor.normalized,
                                 {}});
    }
    for (const auto &mesh : model.meshes) {
        out.meshes.push_back({out.keep(mesh.name), out.primitives.size(), mesh.primitives.size(), false, HEWN_GLTF_NONE,
                              HEWN_GLTF_NONE});
        for (const auto &primitive : mesh.primitives)
            take_primitive(primitive, out);
    }
    for (const auto &node : model.nodes) {
        hewn_gltf_node taken{out.keep(node.name), node.mesh, {}, out.children.size(), node.children.size()};
        compose_matrix(node, taken.matrix);
        out.children.insert(out.children.end(), node.children.begin(), node.children.end());
        out.nodes.push_back(taken);
    }
    for (const auto &material : model.materials)
        out.materials.push_back(out.keep(material.name));
    take_roots(model, out);
}

/* --- what tinygltf does not read, or not in full -------------------------------------------------------------------
 */

/* The member of an object, or null. */
const json &member(const json &from, const char *key)
{
    static const json none;
    auto found = from.is_object() ? from.find(key) : from.end();
    return from.is_object() && found != from.end() ? *found : none;
}

uint64_t size_at(const json &from, const char *key, const char *what)
{
    const json &found = member(from, key);
    if (found.is_null())
        return 0;
    if (!found.is_number_unsigned())
        throw bad_gltf{HEWN_BAD_INPUT, std::string(what) + " with a \"" + key + "\" that is no size"};
    return found.get<uint64_t>();
}

/* The number of an item, or none where there is no such member. */
int index_at(const json &from, const char *key, const char *what)
{
    const json &found = member(from, key);
    if (found.is_null())
        return HEWN_GLTF_NONE;
    if (!found.is_number_unsigned() || found.get<uint64_t>() > most_items)
        throw bad_gltf{HEWN_BAD_INPUT, std::string(what) + " with a \"" + key + "\" that names nothing"};
    return found.get<int>();
}

void take_sparse(const json &document, parsed &out)
{
    const json &accessors = member(document, "accessors");
    const char *what = "a sparse accessor";
    for (size_t i = 0; i < out.accessors.size(); i++) {
        const json &sparse = member(accessors[i], "sparse");
        if (sparse.is_null())
            continue;
        hewn_gltf_sparse &taken = out.accessors[i].sparse;
        const json &places = member(sparse, "indices"), &values = member(sparse, "values");
        taken.count = size_at(sparse, "count", what);
        taken.place_view = index_at(places, "bufferView", what);
        taken.place_type = index_at(places, "componentType", what);
        taken.place_offset = size_at(places, "byteOffset", what);
        taken.value_view = index_at(values, "bufferView", what);
        taken.value_offset = size_at(values, "byteOffset", what);
    }
}

void take_topologies(const json &document, parsed &out)
{
    const json &meshes = member(document, "meshes");
    for (size_t i = 0; i < out.meshes.size(); i++) {
        const json &extension = member(member(meshes[i], "extensions"), manifold_extension);
        const json &found = extension.is_null() ? member(member(meshes[i], "extras"), own_topology) : extension;
        const json &primitive = member(found, "manifoldPrimitive");
        if (primitive.is_null())
            continue;
        hewn_gltf_mesh &mesh = out.meshes[i];
        mesh.has_topology = true;
        mesh.topology_indices = index_at(primitive, "indices", manifold_extension);
        mesh.topology_positions = index_at(member(primitive, "attributes"), "POSITION", manifold_extension);
    }
}

std::unique_ptr<parsed> parse(const char *text, size_t length)
{
    json document = json::parse(text, text + length);
    if (!document.is_object())
        throw bad_gltf{HEWN_BAD_INPUT, "the JSON is not an object"};
    check_extensions(document);
    auto out = std::make_unique<parsed>();
    take_buffers(document, *out);
    json kept = json::object();
    auto asset = document.find("asset");
    if (asset == document.end() || !asset->is_object())
        throw bad_gltf{HEWN_BAD_INPUT, "there is no \"asset\", so this is not glTF"};
    keep_scalar(*asset, kept["asset"] = json::object(), "version");
    keep_scalar(document, kept, "scene");
    keep_all(document, kept, "bufferViews", keep_view);
    keep_all(document, kept, "accessors", keep_accessor);
    keep_all(document, kept, "meshes", keep_mesh);
    keep_all(document, kept, "nodes", keep_node);
    keep_all(document, kept, "scenes", keep_scene);
    keep_all(document, kept, "materials", keep_material);
    std::string filtered = kept.dump(-1, ' ', false, json::error_handler_t::replace);
    kept = json();
    if (filtered.size() > UINT32_MAX)
        throw bad_gltf{HEWN_LIMIT, "more than 4 GiB of JSON"};
    tinygltf::Model model;
    tinygltf::TinyGLTF reader;
    std::string problem, warning;
    if (!reader.LoadASCIIFromString(&model, &problem, &warning, filtered.data(), static_cast<unsigned>(filtered.size()),
                                    "", tinygltf::REQUIRE_VERSION))
        throw bad_gltf{HEWN_BAD_INPUT, problem.empty() ? "unusable glTF" : first_line(problem)};
    if (model.asset.version.rfind("2.", 0) != 0)
        throw bad_gltf{HEWN_BAD_INPUT, "glTF version " + as_utf8(model.asset.version.c_str()) + " instead of 2.x"};
    take_model(model, *out);
    take_sparse(document, *out);
    take_topologies(document, *out);
    take_base_colors(document, *out);
    return out;
}

void expose(std::unique_ptr<parsed> from, hewn_gltf *out)
{
    out->buffers = from->buffers.data();
    out->views = from->views.data();
    out->accessors = from->accessors.data();
    out->attributes = from->attributes.data();
    out->materials = from->materials.data();
    out->colors = reinterpret_cast<const float(*)[4]>(from->colors.data());
    out->primitives = from->primitives.data();
    out->meshes = from->meshes.data();
    out->nodes = from->nodes.data();
    out->children = from->children.data();
    out->roots = from->roots.data();
    out->buffer_count = from->buffers.size();
    out->view_count = from->views.size();
    out->accessor_count = from->accessors.size();
    out->attribute_count = from->attributes.size();
    out->material_count = from->materials.size();
    out->primitive_count = from->primitives.size();
    out->mesh_count = from->meshes.size();
    out->node_count = from->nodes.size();
    out->child_count = from->children.size();
    out->root_count = from->roots.size();
    out->owner = from.release();
}

} // namespace

hewn_result hewn_gltf_compose(const hewn_gltf_desc *desc, hewn_text *out, hewn_error *error)
{
    try {
        std::string text = compose(*desc);
        hewn_text_append_bytes(out, text.data(), text.size());
        return hewn_text_status(out, error);
    } catch (const std::bad_alloc &) {
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory making glTF's JSON");
    } catch (const std::exception &failure) {
        return hewn_fail(error, HEWN_INTERNAL, "glTF's JSON could not be made: %s", failure.what());
    }
}

hewn_result hewn_gltf_parse(const char *text, size_t length, const char *name, hewn_gltf *out, hewn_error *error)
{
    *out = hewn_gltf();
    try {
        expose(parse(text, length), out);
        return HEWN_OK;
    } catch (const bad_gltf &failure) {
        return hewn_fail_at(error, failure.code, name, 0, "%s", failure.message.c_str());
    } catch (const json::exception &failure) {
        const std::string what = first_line(failure.what());
        size_t tag = what.find("] ");
        return hewn_fail_at(error, HEWN_BAD_INPUT, name, 0, "glTF's JSON: %s",
                            as_utf8(what.c_str() + (tag == std::string::npos ? 0 : tag + 2)).c_str());
    } catch (const std::bad_alloc &) {
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, name, 0, "out of memory reading glTF's JSON");
    } catch (const std::exception &failure) {
        return hewn_fail_at(error, HEWN_BAD_INPUT, name, 0, "glTF's JSON: %s", failure.what());
    }
}

void hewn_gltf_free(hewn_gltf *gltf)
{
    delete static_cast<parsed *>(gltf->owner);
    *gltf = hewn_gltf();
}
