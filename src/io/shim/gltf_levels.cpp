#include "io/shim/gltf_levels.h"

#include <new>
#include <set>
#include <string>

#include <nlohmann/json.hpp>

extern "C" {
#include "base/error.h"
}

using nlohmann::json;

namespace
{

/* What a level's numbers of views, accessors and materials grow by where it joins the others. */
struct offsets {
    size_t bytes, views, accessors, materials;
};

void move_number(json &object, const char *key, size_t by)
{
    if (object.contains(key))
        object[key] = object[key].get<size_t>() + by;
}

void move_attributes(json &primitive, const offsets &by)
{
    for (auto &attribute : primitive["attributes"].items())
        attribute.value() = attribute.value().get<size_t>() + by.accessors;
    move_number(primitive, "indices", by.accessors);
}

/* Where a mesh says which of its vertices are one, as an extension or in its extras. */
void move_topology(json &holder, const offsets &by)
{
    for (auto &entry : holder.items()) {
        json &topology = entry.value();
        if (!topology.is_object() || !topology.contains("manifoldPrimitive"))
            continue;
        move_attributes(topology["manifoldPrimitive"], by);
        move_number(topology, "mergeIndices", by.accessors);
        move_number(topology, "mergeValues", by.accessors);
    }
}

void move_mesh(json &mesh, const offsets &by)
{
    for (json &primitive : mesh["primitives"]) {
        move_attributes(primitive, by);
        move_number(primitive, "material", by.materials);
    }
    for (const char *key : {"extensions", "extras"})
        if (mesh.contains(key))
            move_topology(mesh[key], by);
}

void move_accessor(json &accessor, const offsets &by)
{
    move_number(accessor, "bufferView", by.views);
    if (!accessor.contains("sparse"))
        return;
    move_number(accessor["sparse"]["indices"], "bufferView", by.views);
    move_number(accessor["sparse"]["values"], "bufferView", by.views);
}

size_t count_of(const json &document, const char *key)
{
    return document.contains(key) ? document[key].size() : 0;
}

void append(json &to, json &from, const char *key)
{
    for (size_t i = 0; i < count_of(from, key); i++)
        to[key].push_back(std::move(from[key][i]));
}

/* Materials of all levels have the same names; one that is there already is not made again. */
size_t add_materials(json &to, json &from)
{
    size_t there = count_of(to, "materials");
    if (there > 0 && count_of(from, "materials") == there && to["materials"] == from["materials"])
        return 0;
    append(to, from, "materials");
    return there;
}

void add_level(json &to, json &level, size_t bytes, std::set<std::string> &extensions)
{
    offsets by = {bytes, count_of(to, "bufferViews"), count_of(to, "accessors"), add_materials(to, level)};
    for (size_t i = 0; i < count_of(level, "bufferViews"); i++) {
        json &view = level["bufferViews"][i];
        view["byteOffset"] = view.value("byteOffset", size_t(0)) + by.bytes;
    }
    for (size_t i = 0; i < count_of(level, "accessors"); i++)
        move_accessor(level["accessors"][i], by);
    for (size_t i = 0; i < count_of(level, "meshes"); i++)
        move_mesh(level["meshes"][i], by);
    for (size_t i = 0; i < count_of(level, "extensionsUsed"); i++)
        extensions.insert(level["extensionsUsed"][i].get<std::string>());
    append(to, level, "bufferViews");
    append(to, level, "accessors");
    append(to, level, "meshes");
}

/* The first node is the scene's, and names the others. */
void add_nodes(json &to, const std::string &name, const std::vector<bool> &filled, const double *coverages)
{
    size_t meshes = 0;
    json others = json::array();
    for (size_t i = 0; i < filled.size(); i++) {
        json node = {{"name", i == 0 ? name : name + "_LOD" + std::to_string(i)}};
        if (filled[i])
            node["mesh"] = meshes++;
        if (i > 0)
            others.push_back(i);
        to["nodes"].push_back(node);
    }
    if (filled.size() < 2)
        return;
    to["nodes"][0]["extensions"]["MSFT_lod"]["ids"] = others;
    for (size_t i = 0; i < filled.size(); i++)
        to["nodes"][0]["extras"]["MSFT_screencoverage"].push_back(coverages[i]);
}

std::string join(const hewn_text *documents, const uint64_t *binaries, const double *coverages, size_t count)
{
    json all;
    std::set<std::string> extensions;
    std::vector<bool> filled;
    std::string name;
    size_t bytes = 0;
    for (size_t i = 0; i < count; i++) {
        json level = json::parse(documents[i].bytes, documents[i].bytes + documents[i].length);
        if (i == 0) {
            all["asset"] = level["asset"];
            name = level["scenes"][0].value("name", std::string());
        }
        filled.push_back(count_of(level, "meshes") > 0);
        add_level(all, level, bytes, extensions);
        bytes += binaries[i];
    }
    add_nodes(all, name, filled, coverages);
    all["scene"] = 0;
    all["scenes"] = json::array({{{"name", name}, {"nodes", json::array({0})}}});
    if (bytes > 0)
        all["buffers"] = json::array({{{"byteLength", bytes}}});
    if (count > 1)
        extensions.insert("MSFT_lod");
    for (const std::string &extension : extensions)
        all["extensionsUsed"].push_back(extension);
    return all.dump();
}

size_t add_view(json &document, uint64_t offset, uint64_t length)
{
    document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", length}});
    return document["bufferViews"].size() - 1;
}

std::string add_clusters(const hewn_text &document, const hewn_gltf_clusters &what)
{
    json all = json::parse(document.bytes, document.bytes + document.length);
    if (count_of(all, "meshes") == 0)
        return all.dump();
    json &clusters = all["meshes"][0]["extras"]["hewn_clusters"];
    uint64_t at = what.begin;
    clusters["version"] = 1;
    clusters["count"] = what.count;
    clusters["levels"] = what.level_count;
    clusters["clusters"] = add_view(all, at, what.cluster_bytes);
    clusters["vertices"] = add_view(all, at += what.cluster_bytes, what.vertex_bytes);
    clusters["corners"] = add_view(all, at += what.vertex_bytes, what.corner_bytes);
    all["buffers"][0]["byteLength"] = at + what.corner_bytes;
    return all.dump();
}

template <typename Make>
hewn_result guard(Make make, hewn_text *out, hewn_error *error)
{
    try {
        std::string text = make();
        hewn_text_append_bytes(out, text.data(), text.size());
        return hewn_text_status(out, error);
    } catch (const std::bad_alloc &) {
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory making glTF's JSON");
    } catch (const std::exception &failure) {
        return hewn_fail(error, HEWN_INTERNAL, "glTF's JSON could not be made: %s", failure.what());
    }
}

} // namespace

hewn_result hewn_gltf_join_levels(const hewn_text *documents, const uint64_t *binaries, const double *coverages,
                                  size_t count, hewn_text *out, hewn_error *error)
{
    return guard([&] { return join(documents, binaries, coverages, count); }, out, error);
}

hewn_result hewn_gltf_add_clusters(const hewn_text *document, const hewn_gltf_clusters *clusters, hewn_text *out,
                                   hewn_error *error)
{
    return guard([&] { return add_clusters(*document, *clusters); }, out, error);
}
