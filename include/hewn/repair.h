/* Polygon soup into a mesh: weld, clean, orient, split what is not manifold, drop crumbs, fill holes; each counted. */
#ifndef HEWN_REPAIR_H
#define HEWN_REPAIR_H

#include "hewn/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What becomes of faces that run around the same corners in opposite directions (of several that run the same way the
 * lowest is kept in any case). */
typedef enum hewn_opposite {
    HEWN_OPPOSITE_ONE,    /* the lowest face stays: sheets given once for each side become one sheet */
    HEWN_OPPOSITE_KEEP,   /* one of each direction stays: right for solids that share a wall */
    HEWN_OPPOSITE_CANCEL, /* both go: solids that share a wall become one */
    HEWN_OPPOSITE_COUNT
} hewn_opposite;

/* Which closed components are turned over where their signed volume is negative. */
typedef enum hewn_outward {
    HEWN_OUTWARD_TURNED, /* those in which faces had to be turned anyway; consistent ones may well be cavities */
    HEWN_OUTWARD_NEVER,
    HEWN_OUTWARD_ALWAYS, /* every closed component, cavities too */
    HEWN_OUTWARD_COUNT
} hewn_outward;

/* The most boundary edges of a hole that can be filled: time grows with their cube, memory with their square. */
enum { HEWN_FILL_LIMIT = 512 };

/* What to do. All zero: nothing is welded, filled or removed for its size; degenerate and duplicate faces and isolated
 * vertices go, faces are oriented, and what is not manifold is split. The steps run in the order of the members, but
 * that components are turned outward once holes are filled.
 *
 * weld: vertices that a chain of steps of at most weld_distance (scene units, 0: equal positions only, -0 equals 0)
 * joins become one, the lowest of them, which keeps its position. Which vertices are joined does not depend on their
 * order. Copies that splitting makes share a position, so welding a result again undoes the split.
 *
 * Degenerate faces: repeated neighbours among a face's corners are dropped; a face that visits a vertex twice is cut
 * there into simple ones; what then has fewer than three corners goes. drop_flat also drops faces whose area is 0 in
 * double precision (which opens slits where they closed something).
 *
 * Orientation: breadth-first over edges of two faces from the lowest face of each component, then the majority keeps
 * its side (of as many, the lowest face). A one-sided component is cut along the edges where the search meets itself.
 *
 * An edge of more than two faces is cut, and its faces are sewn together in pairs again: sorted by angle around the
 * edge, two neighbours that bound a wedge of the inside belong together (nested wedges from the inside out), so solids
 * that touch along an edge come apart and stay closed. What finds no partner stays open. (Gueziec, Taubin, Lazarus and
 * Horn 2001, 'Cutting and stitching'.) A vertex gets a copy for each fan beyond the first.
 *
 * Filling: the triangulation of least largest dihedral angle, then least area (Barequet and Sharir 1995; Liepa 2003,
 * 'Filling holes in meshes'), never with an edge that exists; holes of more than 8 edges are then refined to the
 * spacing of their rim and faired to a thin plate; fill_flat leaves both out. Patches may pass through other parts of
 * the surface. The rim of an open sheet is a hole like any other.
 *
 * strict: instead of repairing, the first degenerate or duplicate face, pair of faces that disagree in direction,
 * non-manifold edge or vertex, hole that would be filled and component that would be removed is HEWN_BAD_INPUT, naming
 * vertices and faces by their numbers in the soup. Welding is done as asked; isolated vertices are dropped. */
typedef struct hewn_repair_desc {
    bool weld;
    double weld_distance;
    bool drop_flat;
    hewn_opposite opposite;
    bool keep_directions; /* do not turn faces: neighbours that disagree are cut apart */
    hewn_outward outward;
    uint64_t least_faces; /* components (of faces joined by edges) of fewer faces are removed */
    double least_share;   /* and those whose box is smaller than this share of the whole box, by diagonal; 0 to 1 */
    uint32_t fill_edges;  /* holes of up to this many edges are filled, at most HEWN_FILL_LIMIT */
    bool fill_flat;
    bool keep_isolated; /* vertices without a face stay */
    bool strict;
    const hewn_progress *progress; /* or NULL; the stage is "repair" */
} hewn_repair_desc;

/* How often each step found something to do. */
typedef struct hewn_repair_report {
    uint64_t welded_vertices;       /* that became another one */
    uint64_t cleaned_faces;         /* that lost repeated corners, or were cut where they met themselves */
    uint64_t degenerate_faces;      /* dropped */
    uint64_t flat_faces;            /* dropped for their area */
    uint64_t duplicate_faces;       /* dropped */
    uint64_t turned_faces;          /* of those that stayed */
    uint64_t turned_components;     /* closed ones turned outward as a whole, their faces counted above */
    uint64_t one_sided_cuts;        /* edges of two faces that had to be cut for the sake of orientation */
    uint64_t non_manifold_edges;    /* of more than two faces, split */
    uint64_t non_manifold_vertices; /* split, ends of the edges above among them */
    uint64_t vertex_copies;         /* made by splitting */
    uint64_t removed_components;
    uint64_t removed_faces; /* with them */
    uint64_t filled_holes;
    uint64_t filled_edges; /* boundary edges that the filled holes had */
    uint64_t added_faces;  /* by filling */
    uint64_t added_vertices;
    uint64_t kept_holes;        /* within fill_edges, but every triangulation would need an edge or face that exists */
    uint64_t isolated_vertices; /* dropped, with those that lost their faces above */
} hewn_repair_report;

/* Where each element of the result comes from in the soup: HEWN_NONE for what filling made. Owned; free it with
 * hewn_repair_origins_destroy(). Result vertex v is mesh vertex v and face f is mesh face f; the corners of face f are
 * first[f] to first[f + 1] - 1, in order around it, and corner c lies at mesh vertex corners[c]. A split or cut face
 * makes several with the same origin. */
typedef struct hewn_repair_origins {
    uint64_t vertex_count, face_count;
    uint64_t *first;
    uint32_t *corners;
    uint32_t *vertex_origins;
    uint32_t *corner_origins; /* positions in the soup's corner list */
    uint32_t *face_origins;
} hewn_repair_origins;

/* Fills in the defaults that zero stands for. */
HEWN_API hewn_repair_desc hewn_repair_desc_default(void);

/* Makes a mesh from any polygons. `desc` (NULL: defaults), `report` and `origins` may be NULL. Time is n log n but for
 * filling. The same input gives the same bytes. HEWN_BAD_INPUT for a position that is not finite, an index out of range
 * or a `first` that falls, naming it, and for what strict refuses; HEWN_INVALID_ARGUMENT for a bad desc; HEWN_LIMIT for
 * 2^32 - 2 corners or vertices and more; HEWN_OUT_OF_MEMORY; HEWN_CANCELLED. Thread-safe. */
HEWN_API hewn_result hewn_mesh_from_soup(const hewn_polygons *soup, const hewn_repair_desc *desc, hewn_mesh **out,
                                         hewn_repair_report *report, hewn_repair_origins *origins, hewn_error *error);
HEWN_API void hewn_repair_origins_destroy(hewn_repair_origins *origins);

#ifdef __cplusplus
}
#endif
#endif
