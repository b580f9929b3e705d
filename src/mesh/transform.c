#include "mesh/mesh_data.h"

#include <math.h>

#include "base/alloc.h"

/* --- turning over ------------------------------------------------------------------------------------------------- */

/* Corner values follow their vertex: the half-edge that will end where h ends is the one after it in the old order. */
static void rotate_corners(hewn_mesh *mesh, uint32_t first)
{
    for (uint32_t i = 0; i < mesh->attribute_count; i++) {
        mesh_attribute *attribute = &mesh->attributes[i];
        if (attribute->info.domain != HEWN_DOMAIN_CORNER)
            continue;
        for (uint32_t h = mesh->prev[first]; h != first; h = mesh->prev[h]) {
            unsigned char *a = attribute->data + h * attribute->stride;
            unsigned char *b = attribute->data + mesh->next[h] * attribute->stride;
            for (size_t k = 0; k < attribute->stride; k++) {
                unsigned char byte = a[k];
                a[k] = b[k];
                b[k] = byte;
            }
        }
    }
}

void hewn_mesh_reverse_topology(hewn_mesh *mesh)
{
    bool corners = hewn_mesh_has_values(mesh, HEWN_DOMAIN_CORNER);
    for (uint32_t f = 0; f < mesh->face_bound; f++) {
        if (!mesh_has_face(mesh, f))
            continue;
        if (corners)
            rotate_corners(mesh, mesh->face_half[f]);
        mesh->face_half[f] = mesh->next[mesh->face_half[f]];
    }
    /* What arrived before a half-edge in its loop leaves its tail now. */
    for (uint32_t v = 0; v < mesh->vert_bound; v++)
        if (mesh->vert_half[v] < MESH_DELETED)
            mesh->vert_half[v] = mesh->prev[mesh->vert_half[v]];
    for (uint32_t h = 0; h < mesh->half_bound; h++) {
        uint32_t next = mesh->next[h];
        mesh->next[h] = mesh->prev[h];
        mesh->prev[h] = next;
        if ((h & 1) == 0) {
            uint32_t head = mesh->head[h];
            mesh->head[h] = mesh->head[h + 1];
            mesh->head[h + 1] = head;
        }
    }
}

/* --- normals ------------------------------------------------------------------------------------------------------ */

/* Normals by a row-major 3 x 3 matrix; with `unit` their length becomes 1, but for those of length 0. */
static void turn_normals(hewn_mesh *mesh, const double matrix[9], bool unit)
{
    for (uint32_t i = 0; i < mesh->attribute_count; i++) {
        mesh_attribute *attribute = &mesh->attributes[i];
        uint32_t bound = mesh_domain_bound(mesh, attribute->info.domain);
        for (uint32_t e = 0; attribute->direction && e < bound; e++) {
            double old[3], normal[3];
            hewn_mesh_read_direction(attribute, e, old);
            for (int k = 0; k < 3; k++)
                normal[k] = matrix[3 * k] * old[0] + matrix[3 * k + 1] * old[1] + matrix[3 * k + 2] * old[2];
            double length = unit ? sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]) : 1;
            if (length > 0 && isfinite(length))
                for (int k = 0; k < 3; k++)
                    normal[k] /= length;
            hewn_mesh_write_direction(attribute, e, normal);
        }
    }
}

void hewn_mesh_reverse(hewn_mesh *mesh)
{
    static const double minus[9] = {-1, 0, 0, 0, -1, 0, 0, 0, -1};
    hewn_mesh_reverse_topology(mesh);
    turn_normals(mesh, minus, false);
}

/* --- matrices ----------------------------------------------------------------------------------------------------- */

static void apply(const double matrix[12], const double point[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] =
            matrix[4 * k] * point[0] + matrix[4 * k + 1] * point[1] + matrix[4 * k + 2] * point[2] + matrix[4 * k + 3];
}

/* A multiple of the inverse transpose of the 3 x 3 part, and the determinant of that part with its rows scaled to a
 * size near 1: the cofactors of the scaled part, each row divided by its scale again. */
static double inverse_transpose(const double matrix[12], double out[9])
{
    double part[9], scale[3], least = INFINITY;
    for (int row = 0; row < 3; row++) {
        const double *at = matrix + 4 * row;
        scale[row] = fmax(fabs(at[0]), fmax(fabs(at[1]), fabs(at[2])));
        if (scale[row] == 0)
            return 0;
        least = fmin(least, scale[row]);
        for (int column = 0; column < 3; column++)
            part[3 * row + column] = at[column] / scale[row];
    }
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++) {
            int r1 = (row + 1) % 3, r2 = (row + 2) % 3, c1 = (column + 1) % 3, c2 = (column + 2) % 3;
            out[3 * row + column] = part[3 * r1 + c1] * part[3 * r2 + c2] - part[3 * r1 + c2] * part[3 * r2 + c1];
        }
    double determinant = part[0] * out[0] + part[1] * out[1] + part[2] * out[2];
    for (int i = 0; i < 9; i++)
        out[i] *= least / scale[i / 3];
    return determinant;
}

static hewn_result check_positions(const hewn_mesh *mesh, const double matrix[12], hewn_error *error)
{
    for (uint32_t v = 0; v < mesh->vert_bound; v++) {
        double moved[3];
        if (!mesh_has_vert(mesh, v))
            continue;
        apply(matrix, mesh->position + 3 * (size_t)v, moved);
        if (!isfinite(moved[0]) || !isfinite(moved[1]) || !isfinite(moved[2]))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the matrix moves vertex %u out of the numbers", v);
    }
    return HEWN_OK;
}

hewn_result hewn_mesh_transform(hewn_mesh *mesh, const double matrix[12], hewn_error *error)
{
    double normals[9];
    for (int i = 0; i < 12; i++)
        if (!isfinite(matrix[i]))
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the matrix is not finite");
    double determinant = inverse_transpose(matrix, normals);
    if (determinant == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the matrix is singular");
    HEWN_TRY(check_positions(mesh, matrix, error));
    for (uint32_t v = 0; v < mesh->vert_bound; v++) {
        double *position = mesh->position + 3 * (size_t)v, moved[3];
        apply(matrix, position, moved);
        for (int k = 0; k < 3; k++)
            position[k] = moved[k];
    }
    for (int i = 0; i < 9 && determinant < 0; i++)
        normals[i] = -normals[i];
    turn_normals(mesh, normals, true);
    if (determinant < 0)
        hewn_mesh_reverse_topology(mesh);
    return HEWN_OK;
}
