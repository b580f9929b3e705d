#include "hewn/triangles.h"

#include "base/alloc.h"

void hewn_triangles_destroy(hewn_triangles *triangles)
{
    if (!triangles)
        return;
    if (triangles->release) {
        triangles->release(triangles->owner);
    } else {
        hewn_free(triangles->positions);
        hewn_free(triangles->normals);
        hewn_free(triangles->indices);
    }
    *triangles = (hewn_triangles){0};
}
