#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include "load_peers.h"

peer_loaded assimp_load(const char *path)
{
    const aiScene *scene = aiImportFile(path, aiProcess_JoinIdenticalVertices);
    if (!scene)
        return {nullptr, 0, 0};
    unsigned long long vertices = 0, faces = 0;
    for (unsigned i = 0; i < scene->mNumMeshes; i++) {
        vertices += scene->mMeshes[i]->mNumVertices;
        faces += scene->mMeshes[i]->mNumFaces;
    }
    return {const_cast<aiScene *>(scene), vertices, faces};
}

void assimp_release(void *scene)
{
    aiReleaseImport(static_cast<const aiScene *>(scene));
}
