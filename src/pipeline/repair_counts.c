#include "pipeline/repair_counts.h"

#include <stddef.h>
#include <string.h>

#define COUNT(name, text)                                                                                              \
    {                                                                                                                  \
#name, text, offsetof(hewn_repair_report, name)                                                                \
    }

static const hewn_repair_count counts[] = {
    COUNT(welded_vertices, "vertices welded to another"),
    COUNT(cleaned_faces, "faces freed of repeated corners"),
    COUNT(degenerate_faces, "degenerate faces dropped"),
    COUNT(flat_faces, "faces without area dropped"),
    COUNT(duplicate_faces, "duplicate faces dropped"),
    COUNT(turned_faces, "faces turned over"),
    COUNT(turned_components, "components turned outward"),
    COUNT(one_sided_cuts, "edges of one-sided parts cut"),
    COUNT(non_manifold_edges, "non-manifold edges split"),
    COUNT(non_manifold_vertices, "non-manifold vertices split"),
    COUNT(vertex_copies, "copies of vertices made by splitting"),
    COUNT(removed_components, "small components removed"),
    COUNT(removed_faces, "faces removed with them"),
    COUNT(filled_holes, "holes filled"),
    COUNT(filled_edges, "boundary edges that they had"),
    COUNT(added_faces, "faces added by filling"),
    COUNT(added_vertices, "vertices added by filling"),
    COUNT(kept_holes, "holes that could not be filled"),
    COUNT(isolated_vertices, "vertices without a face dropped"),
};

_Static_assert(sizeof counts / sizeof *counts == sizeof(hewn_repair_report) / sizeof(uint64_t),
               "every count of the report is in the table");

const hewn_repair_count *hewn_repair_count_at(size_t index)
{
    return index < sizeof counts / sizeof *counts ? &counts[index] : NULL;
}

uint64_t hewn_repair_count_of(const hewn_repair_report *report, const hewn_repair_count *count)
{
    uint64_t value;
    memcpy(&value, (const char *)report + count->offset, sizeof value);
    return value;
}
