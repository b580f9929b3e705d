#include "osd_peer.h"

#ifndef HEWN_HAS_OSD

bool osd_is_there(void)
{
    return false;
}

bool osd_refine(const osd_request *, double *, double *, double *, double *)
{
    return false;
}

#else

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <vector>

#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>

namespace
{
using namespace OpenSubdiv;

template <int N>
struct Value {
    std::array<double, N> at{};
    void Clear()
    {
        at.fill(0);
    }
    void AddWithWeight(const Value &other, double weight)
    {
        for (int i = 0; i < N; i++)
            at[i] += weight * other.at[i];
    }
};

Sdc::Options options_of(const hewn_subdivide_desc *desc)
{
    static const Sdc::Options::VtxBoundaryInterpolation boundary[] = {Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER,
                                                                      Sdc::Options::VTX_BOUNDARY_EDGE_ONLY,
                                                                      Sdc::Options::VTX_BOUNDARY_NONE};
    static const Sdc::Options::FVarLinearInterpolation uv[] = {
        Sdc::Options::FVAR_LINEAR_CORNERS_PLUS1, Sdc::Options::FVAR_LINEAR_NONE,
        Sdc::Options::FVAR_LINEAR_CORNERS_ONLY,  Sdc::Options::FVAR_LINEAR_CORNERS_PLUS2,
        Sdc::Options::FVAR_LINEAR_BOUNDARIES,    Sdc::Options::FVAR_LINEAR_ALL};
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(boundary[desc->boundary]);
    options.SetCreasingMethod(desc->creasing == HEWN_CREASING_CHAIKIN ? Sdc::Options::CREASE_CHAIKIN
                                                                      : Sdc::Options::CREASE_UNIFORM);
    options.SetFVarLinearInterpolation(uv[desc->uv]);
    return options;
}

/* Control topology as OpenSubdiv wants it; uv values of a vertex that have the same bits are one. */
struct Control {
    std::vector<int> sides, corners, creases, tagged, uv_index;
    std::vector<float> crease_sharpness, tag_sharpness;
    std::vector<Value<2>> uv;
    std::unique_ptr<Far::TopologyRefiner> refiner;

    explicit Control(const osd_request *request)
    {
        const hewn_polygons *polygons = request->polygons;
        const hewn_subdivide_desc *desc = request->desc;
        std::map<std::array<double, 3>, int> known;
        for (uint64_t f = 0; f < polygons->face_count; f++) {
            uint64_t begin = polygons->first ? polygons->first[f] : 3 * f;
            uint64_t end = polygons->first ? polygons->first[f + 1] : 3 * f + 3;
            sides.push_back(static_cast<int>(end - begin));
            for (uint64_t c = begin; c < end; c++) {
                corners.push_back(static_cast<int>(polygons->corners[c]));
                if (!request->uv)
                    continue;
                std::array<double, 3> key{static_cast<double>(polygons->corners[c]), request->uv[2 * c],
                                          request->uv[2 * c + 1]};
                auto found = known.emplace(key, static_cast<int>(uv.size()));
                if (found.second)
                    uv.push_back(Value<2>{{request->uv[2 * c], request->uv[2 * c + 1]}});
                uv_index.push_back(found.first->second);
            }
        }
        for (uint64_t i = 0; i < desc->crease_count; i++) {
            creases.push_back(static_cast<int>(desc->creases[i].verts[0]));
            creases.push_back(static_cast<int>(desc->creases[i].verts[1]));
            crease_sharpness.push_back(static_cast<float>(desc->creases[i].sharpness));
        }
        for (uint64_t i = 0; i < desc->corner_count; i++) {
            tagged.push_back(static_cast<int>(desc->corners[i].vert));
            tag_sharpness.push_back(static_cast<float>(desc->corners[i].sharpness));
        }
        build(request);
    }

    void build(const osd_request *request)
    {
        Far::TopologyDescriptor to;
        Far::TopologyDescriptor::FVarChannel channel;
        to.numVertices = static_cast<int>(request->polygons->vertex_count);
        to.numFaces = static_cast<int>(sides.size());
        to.numVertsPerFace = sides.data();
        to.vertIndicesPerFace = corners.data();
        to.numCreases = static_cast<int>(crease_sharpness.size());
        to.creaseVertexIndexPairs = creases.data();
        to.creaseWeights = crease_sharpness.data();
        to.numCorners = static_cast<int>(tagged.size());
        to.cornerVertexIndices = tagged.data();
        to.cornerWeights = tag_sharpness.data();
        channel.numValues = static_cast<int>(uv.size());
        channel.valueIndices = uv_index.data();
        if (request->uv) {
            to.numFVarChannels = 1;
            to.fvarChannels = &channel;
        }
        static const Sdc::SchemeType schemes[] = {Sdc::SCHEME_CATMARK, Sdc::SCHEME_LOOP, Sdc::SCHEME_BILINEAR};
        using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
        Factory::Options options(schemes[request->desc->scheme], options_of(request->desc));
        refiner.reset(Factory::Create(to, options));
        if (!refiner)
            return;
        Far::TopologyRefiner::UniformOptions uniform(static_cast<int>(request->subdivision->count));
        uniform.fullTopologyInLastLevel = true;
        if (request->subdivision->count > 0)
            refiner->RefineUniform(uniform);
    }
};

/* OpenSubdiv's vertices and faces of a level, by Hewn's numbers. */
struct Numbers {
    std::vector<int> verts, faces;
};

Numbers next_numbers(const Far::TopologyRefiner &refiner, int at, const sub_level &level, const Numbers &now,
                     bool triangles)
{
    const Far::TopologyLevel &theirs = refiner.GetLevel(at);
    Numbers next;
    for (int v : now.verts)
        next.verts.push_back(theirs.GetVertexChildVertex(v));
    for (uint32_t e = 0; e < level.edges; e++)
        next.verts.push_back(theirs.GetEdgeChildVertex(
            theirs.FindEdge(now.verts[level.edge_verts[2 * e]], now.verts[level.edge_verts[2 * e + 1]])));
    const Far::TopologyLevel &after = refiner.GetLevel(at + 1);
    for (uint32_t f = 0; f < level.faces; f++) {
        int face = now.faces[f];
        if (!triangles)
            next.verts.push_back(theirs.GetFaceChildVertex(face));
        /* Hewn's children are in the order of its corners, which may not be the other's: found by the vertex they keep.
         */
        Far::ConstIndexArray children = theirs.GetFaceChildFaces(face);
        std::vector<bool> taken(static_cast<size_t>(children.size()));
        for (uint32_t c = sub_face_begin(&level, f); c < sub_face_begin(&level, f + 1); c++) {
            int kept = theirs.GetVertexChildVertex(now.verts[level.corner_verts[c]]);
            for (int i = 0; i < children.size(); i++)
                if (after.GetFaceVertices(children[i]).FindIndex(kept) >= 0) {
                    next.faces.push_back(children[i]);
                    taken[static_cast<size_t>(i)] = true;
                }
        }
        for (int i = 0; i < children.size(); i++)
            if (!taken[static_cast<size_t>(i)])
                next.faces.push_back(children[i]);
    }
    return next;
}

std::vector<Numbers> all_numbers(const osd_request *request, const Far::TopologyRefiner &refiner)
{
    const hewn_subdivision *sub = request->subdivision;
    std::vector<Numbers> out(1);
    for (uint32_t v = 0; v < sub->levels[0].verts; v++)
        out[0].verts.push_back(static_cast<int>(v));
    for (uint32_t f = 0; f < sub->levels[0].faces; f++)
        out[0].faces.push_back(static_cast<int>(f));
    for (uint32_t i = 0; i < sub->count; i++)
        out.push_back(next_numbers(refiner, static_cast<int>(i), sub->levels[i], out[i],
                                   request->desc->scheme == HEWN_SCHEME_LOOP));
    return out;
}

void write_uv(const osd_request *request, Control &control, const Numbers &last, double *uv)
{
    const hewn_subdivision *sub = request->subdivision;
    Far::PrimvarRefinerReal<double> primvars(*control.refiner);
    std::vector<Value<2>> from = control.uv, to;
    for (int i = 1; i <= static_cast<int>(sub->count); i++) {
        to.assign(static_cast<size_t>(control.refiner->GetLevel(i).GetNumFVarValues(0)), Value<2>{});
        Value<2> *target = to.data();
        primvars.InterpolateFaceVarying(i, from.data(), target, 0);
        from.swap(to);
    }
    const Far::TopologyLevel &theirs = control.refiner->GetLevel(static_cast<int>(sub->count));
    const sub_level &level = sub->levels[sub->count];
    for (uint32_t c = 0; c < level.corners; c++) {
        int face = last.faces[sub_face_of(&level, c)], vert = last.verts[level.corner_verts[c]];
        Far::ConstIndexArray verts = theirs.GetFaceVertices(face), values = theirs.GetFaceFVarValues(face, 0);
        for (int k = 0; k < verts.size(); k++)
            if (verts[k] == vert)
                for (int i = 0; i < 2; i++)
                    uv[2 * c + static_cast<uint32_t>(i)] =
                        from[static_cast<size_t>(values[k])].at[static_cast<size_t>(i)];
    }
}
} // namespace

bool osd_is_there(void)
{
    return true;
}

bool osd_refine(const osd_request *request, double *points, double *limits, double *normals, double *uv)
{
    Control control(request);
    if (!control.refiner)
        return false;
    std::vector<Numbers> numbers = all_numbers(request, *control.refiner);
    const Numbers &last = numbers.back();
    Far::PrimvarRefinerReal<double> primvars(*control.refiner);
    std::vector<Value<3>> from(request->polygons->vertex_count), to;
    for (size_t i = 0; i < 3 * from.size(); i++)
        from[i / 3].at[i % 3] = request->control[i];
    for (int i = 1; i <= static_cast<int>(request->subdivision->count); i++) {
        to.assign(static_cast<size_t>(control.refiner->GetLevel(i).GetNumVertices()), Value<3>{});
        Value<3> *target = to.data();
        primvars.Interpolate(i, from.data(), target);
        from.swap(to);
    }
    for (size_t v = 0; v < last.verts.size(); v++)
        for (size_t i = 0; i < 3; i++)
            points[3 * v + i] = from[static_cast<size_t>(last.verts[v])].at[i];
    if (limits && normals) {
        std::vector<Value<3>> at(from.size()), u(from.size()), w(from.size());
        Value<3> *at_target = at.data(), *u_target = u.data(), *w_target = w.data();
        primvars.Limit(from.data(), at_target, u_target, w_target);
        for (size_t v = 0; v < last.verts.size(); v++) {
            const auto &a = u[static_cast<size_t>(last.verts[v])].at, &b = w[static_cast<size_t>(last.verts[v])].at;
            double n[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
            double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
            for (size_t i = 0; i < 3; i++) {
                limits[3 * v + i] = at[static_cast<size_t>(last.verts[v])].at[i];
                normals[3 * v + i] = length > 0 ? n[i] / length : 0;
            }
        }
    }
    if (uv)
        write_uv(request, control, last, uv);
    return true;
}

#endif
