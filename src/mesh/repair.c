#include "hewn/repair.h"

#include "base/alloc.h"
#include "base/error.h"
#include "mesh/soup.h"

void hewn_repair_origins_destroy(hewn_repair_origins *origins)
{
    hewn_free(origins->first);
    hewn_free(origins->corners);
    hewn_free(origins->vertex_origins);
    hewn_free(origins->corner_origins);
    hewn_free(origins->face_origins);
    *origins = (hewn_repair_origins){0};
}

/* Moves the arrays over; the soup keeps its positions. */
static void take_origins(hewn_soup *soup, hewn_repair_origins *out)
{
    *out = (hewn_repair_origins){.vertex_count = soup->vertex_count,
                                 .face_count = soup->face_count,
                                 .first = soup->first,
                                 .corners = soup->corners,
                                 .vertex_origins = soup->vertex_origins,
                                 .corner_origins = soup->corner_origins,
                                 .face_origins = soup->face_origins};
    soup->first = NULL;
    soup->corners = soup->vertex_origins = soup->corner_origins = soup->face_origins = NULL;
}

static hewn_result build(const hewn_soup *soup, hewn_mesh **out, hewn_error *error)
{
    hewn_polygons polygons = {soup->vertex_count, soup->positions, soup->face_count, soup->first, soup->corners};
    return hewn_mesh_from_polygons(&polygons, out, error);
}

hewn_result hewn_mesh_from_soup(const hewn_polygons *polygons, const hewn_repair_desc *desc, hewn_mesh **out,
                                hewn_repair_report *report, hewn_repair_origins *origins, hewn_error *error)
{
    hewn_repair_desc defaults = hewn_repair_desc_default();
    hewn_repair_report counts = {0};
    hewn_soup soup;
    *out = NULL;
    if (report)
        *report = counts;
    if (origins)
        *origins = (hewn_repair_origins){0};
    HEWN_TRY(hewn_soup_create(polygons, &soup, error));
    hewn_result result = hewn_soup_repair(&soup, desc ? desc : &defaults, &counts, error);
    if (result == HEWN_OK)
        result = build(&soup, out, error);
    if (result == HEWN_OK && report)
        *report = counts;
    if (result == HEWN_OK && origins)
        take_origins(&soup, origins);
    hewn_soup_destroy(&soup);
    return result;
}
