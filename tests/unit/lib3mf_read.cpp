#include "lib3mf_read.h"

#include <cstdlib>

#ifdef HEWN_HAS_LIB3MF

#include <lib3mf/Model/COM/NMR_DLLInterfaces.h>

using namespace NMR;

bool lib3mf_is_there(void)
{
    return true;
}

static bool take_mesh(PLib3MFModelMeshObject *object, lib3mf_facts *out)
{
    out->positions = static_cast<float *>(std::calloc(out->vertices + 1U, 3 * sizeof(float)));
    out->corners = static_cast<uint32_t *>(std::calloc(out->triangles + 1U, 3 * sizeof(uint32_t)));
    bool good = out->positions && out->corners;
    for (uint32_t v = 0; good && v < out->vertices; v++) {
        MODELMESHVERTEX vertex{};
        good = lib3mf_meshobject_getvertex(object, v, &vertex) == LIB3MF_OK;
        for (uint32_t axis = 0; axis < 3; axis++)
            out->positions[3 * v + axis] = vertex.m_fPosition[axis];
    }
    for (uint32_t t = 0; good && t < out->triangles; t++) {
        MODELMESHTRIANGLE triangle{};
        good = lib3mf_meshobject_gettriangle(object, t, &triangle) == LIB3MF_OK;
        for (uint32_t k = 0; k < 3; k++)
            out->corners[3 * t + k] = triangle.m_nIndices[k];
    }
    return good;
}

static bool take_object(PLib3MFModelResource *resource, lib3mf_facts *out)
{
    auto *object = static_cast<PLib3MFModelMeshObject *>(resource);
    DWORD vertices = 0, triangles = 0;
    BOOL manifold = 0;
    MODELMESHVERTEX vertex{};
    bool good = lib3mf_meshobject_getvertexcount(object, &vertices) == LIB3MF_OK &&
                lib3mf_meshobject_gettrianglecount(object, &triangles) == LIB3MF_OK &&
                lib3mf_meshobject_ismanifoldandoriented(object, &manifold) == LIB3MF_OK && vertices > 0 &&
                lib3mf_meshobject_getvertex(object, vertices - 1, &vertex) == LIB3MF_OK;
    out->objects++;
    out->vertices = vertices;
    out->triangles = triangles;
    out->manifold = manifold != 0;
    for (int axis = 0; axis < 3; axis++)
        out->corner[axis] = vertex.m_fPosition[axis];
    lib3mf_forget(out);
    good = good && take_mesh(object, out);
    lib3mf_release(resource);
    return good;
}

static bool take_model(PLib3MFModel *model, const char *path, lib3mf_facts *out)
{
    PLib3MFModelReader *reader = nullptr;
    PLib3MFModelResourceIterator *objects = nullptr;
    DWORD unit = 0, warnings = 0;
    if (lib3mf_model_queryreader(model, "3mf", &reader) != LIB3MF_OK)
        return false;
    bool good = lib3mf_reader_readfromfileutf8(reader, path) == LIB3MF_OK &&
                lib3mf_reader_getwarningcount(reader, &warnings) == LIB3MF_OK &&
                lib3mf_model_getunit(model, &unit) == LIB3MF_OK &&
                lib3mf_model_getmeshobjects(model, &objects) == LIB3MF_OK;
    BOOL more = 0;
    while (good && lib3mf_resourceiterator_movenext(objects, &more) == LIB3MF_OK && more) {
        PLib3MFModelResource *resource = nullptr;
        good = lib3mf_resourceiterator_getcurrent(objects, &resource) == LIB3MF_OK && take_object(resource, out);
    }
    out->unit = unit;
    out->warnings = warnings;
    if (objects)
        lib3mf_release(objects);
    lib3mf_release(reader);
    return good;
}

bool lib3mf_read(const char *path, lib3mf_facts *out)
{
    PLib3MFModel *model = nullptr;
    *out = lib3mf_facts{};
    if (lib3mf_createmodel(&model) != LIB3MF_OK)
        return false;
    bool good = take_model(model, path, out);
    lib3mf_release(model);
    return good;
}

#else

bool lib3mf_is_there(void)
{
    return false;
}

bool lib3mf_read(const char *path, lib3mf_facts *out)
{
    (void)path;
    *out = lib3mf_facts{};
    return false;
}

#endif

void lib3mf_forget(lib3mf_facts *facts)
{
    std::free(facts->positions);
    std::free(facts->corners);
    facts->positions = nullptr;
    facts->corners = nullptr;
}
