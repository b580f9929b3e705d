#include "io/shim/gltf.h"

#include <fstream>
#include <memory>
#include <new>
#include <sstream>
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

/* --- making ----------------------------------------------------------------------------------------------------------
 */

/* Appends a view and an accessor on it, and returns the accessor's number. */
int add_accessor(tinygltf::Model &model, size_t &offset, uint64_t count, int type, int component, size_t item,
                 int target)
{
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = offset;
    view.byteLength = static_cast<size_t>(count) * item;
    view.target = target;
    offset += view.byteLength;
    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(model.bufferViews.size());
    accessor.componentType = component;
    accessor.count = static_cast<size_t>(count);
    accessor.type = type;
    model.bufferViews.push_back(view);
    model.accessors.push_back(accessor);
    return static_cast<int>(model.accessors.size()) - 1;
}

/* The mesh of `desc`; returns the length of its buffer. */
size_t add_mesh(tinygltf::Model &model, const hewn_gltf_desc &desc, const std::string &name)
{
    size_t length = 0;
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    int positions = add_accessor(model, length, desc.vertex_count, TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT,
                                 12, TINYGLTF_TARGET_ARRAY_BUFFER);
    model.accessors[positions].minValues.assign(desc.lo, desc.lo + 3);
    model.accessors[positions].maxValues.assign(desc.hi, desc.hi + 3);
    primitive.attributes["POSITION"] = positions;
    if (desc.has_normals)
        primitive.attributes["NORMAL"] = add_accessor(model, length, desc.vertex_count, TINYGLTF_TYPE_VEC3,
                                                      TINYGLTF_COMPONENT_TYPE_FLOAT, 12, TINYGLTF_TARGET_ARRAY_BUFFER);
    primitive.indices =
        add_accessor(model, length, desc.index_count, TINYGLTF_TYPE_SCALAR,
                     desc.short_indices ? TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT : TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
                     desc.short_indices ? 2 : 4, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    tinygltf::Mesh mesh;
    mesh.name = name;
    mesh.primitives.push_back(primitive);
    model.meshes.push_back(mesh);
    return length;
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
    if (desc.index_count > 0) {
        length = add_mesh(model, desc, name);
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
    if (length > 0)
        document["buffers"] = json::array({{{"byteLength", length}}});
    return document.dump();
}

/* --- reading ---------------------------------------------------------------------------------------------------------
 */

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
    keep_scalar(from, to, "mode");
    keep_scalar(from, to, "indices");
    json &attributes = to["attributes"] = json::object();
    auto found = from.find("attributes");
    if (found != from.end() && found->is_object()) {
        keep_scalar(*found, attributes, "POSITION");
        keep_scalar(*found, attributes, "NORMAL");
    }
    return to;
}

json keep_mesh(const json &from)
{
    json to = json::object();
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

/* Extensions that leave geometry alone may be required without being known. */
void check_extensions(const json &document)
{
    auto found = document.find("extensionsRequired");
    if (found == document.end() || !found->is_array())
        return;
    for (const json &item : *found) {
        std::string name = item.is_string() ? item.get<std::string>() : "?";
        bool harmless = false;
        for (const char *prefix : {"KHR_materials_", "KHR_texture_", "KHR_lights_", "EXT_texture_", "MSFT_texture_"})
            harmless = harmless || name.rfind(prefix, 0) == 0;
        if (!harmless)
            throw bad_gltf{HEWN_BAD_INPUT, "needs the extension " + as_utf8(name.c_str()) + ", which is not supported"};
    }
}

/* The parts of hewn_gltf, and the memory behind its pointers. */
struct parsed {
    std::vector<std::string> uris;
    std::vector<hewn_gltf_buffer> buffers;
    std::vector<hewn_gltf_view> views;
    std::vector<hewn_gltf_accessor> accessors;
    std::vector<hewn_gltf_primitive> primitives;
    std::vector<hewn_gltf_mesh> meshes;
    std::vector<hewn_gltf_node> nodes;
    std::vector<int> children, roots;
};

/* Buffers are read here and not by tinygltf, which would copy the binary chunk once for each. */
void take_buffers(const json &document, parsed &out)
{
    auto found = document.find("buffers");
    if (found == document.end())
        return;
    if (!found->is_array() || found->size() > most_items)
        throw bad_gltf{HEWN_BAD_INPUT, "\"buffers\" is not an array of usable length"};
    out.uris.reserve(found->size()); /* c_str() of each must stay put */
    for (const json &item : *found) {
        auto length = item.is_object() ? item.find("byteLength") : item.end();
        if (!item.is_object() || length == item.end() || !length->is_number_unsigned())
            throw bad_gltf{HEWN_BAD_INPUT, "a buffer without a byteLength"};
        auto uri = item.find("uri");
        bool named = uri != item.end() && uri->is_string();
        out.uris.push_back(named ? uri->get<std::string>() : std::string());
        out.buffers.push_back({named ? out.uris.back().c_str() : nullptr, length->get<uint64_t>()});
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

int attribute(const tinygltf::Primitive &primitive, const char *name)
{
    auto found = primitive.attributes.find(name);
    return found == primitive.attributes.end() ? HEWN_GLTF_NONE : found->second;
}

void take_model(const tinygltf::Model &model, parsed &out)
{
    for (const auto &view : model.bufferViews)
        out.views.push_back({view.buffer, view.byteOffset, view.byteLength, view.byteStride});
    for (const auto &accessor : model.accessors)
        out.accessors.push_back({accessor.bufferView, accessor.byteOffset, accessor.count, accessor.componentType,
                                 tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type)), false,
                                 accessor.normalized});
    for (const auto &mesh : model.meshes) {
        out.meshes.push_back({out.primitives.size(), mesh.primitives.size()});
        for (const auto &primitive : mesh.primitives)
            out.primitives.push_back(
                {primitive.mode, attribute(primitive, "POSITION"), attribute(primitive, "NORMAL"), primitive.indices});
    }
    for (const auto &node : model.nodes) {
        hewn_gltf_node taken{node.mesh, {}, out.children.size(), node.children.size()};
        compose_matrix(node, taken.matrix);
        out.children.insert(out.children.end(), node.children.begin(), node.children.end());
        out.nodes.push_back(taken);
    }
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

/* tinygltf does not say that an accessor was sparse when that part was left out, so it is noted beforehand. */
void note_sparse(const json &document, parsed &out)
{
    auto found = document.find("accessors");
    for (size_t i = 0; found != document.end() && i < out.accessors.size(); i++)
        out.accessors[i].sparse = (*found)[i].contains("sparse");
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
    note_sparse(document, *out);
    return out;
}

void expose(std::unique_ptr<parsed> from, hewn_gltf *out)
{
    out->buffers = from->buffers.data();
    out->views = from->views.data();
    out->accessors = from->accessors.data();
    out->primitives = from->primitives.data();
    out->meshes = from->meshes.data();
    out->nodes = from->nodes.data();
    out->children = from->children.data();
    out->roots = from->roots.data();
    out->buffer_count = from->buffers.size();
    out->view_count = from->views.size();
    out->accessor_count = from->accessors.size();
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
