/* The search for one vertex of dual contouring on the host, step by step: it asks the field at places, and what it is
 * told decides what it asks next. The work of shaders/iso/dual_vertices.glsl and dual_search.h, which say why. */
#ifndef HEWN_SRC_ISO_HOST_SEARCH_H
#define HEWN_SRC_ISO_HOST_SEARCH_H

#include "iso/host_qef.h"
#include "shared/iso.h"

/* Coordinates are in units of cells from the cell's lowest corner, see shaders/iso/dual_place.h. */
typedef struct hewn_host_cell {
    vec corner;
    vec lo, hi; /* where its vertices may be */
} hewn_host_cell;

hewn_host_cell hewn_host_cell_of(const struct hewn_grid *grid, uint32_t packed_brick, const uint32_t at[3]);
vec hewn_host_into_cell(const struct hewn_grid *grid, const hewn_host_cell *cell, vec place);
vec hewn_host_out_of_cell(const struct hewn_grid *grid, const hewn_host_cell *cell, vec at);

/* Most places that a vertex asks about at once, and how often it asks. */
enum { HEWN_SEARCH_QUESTIONS = 9, HEWN_SEARCH_TRIALS = 16 };

typedef enum hewn_search_phase {
    HEWN_SEARCH_SOLVE, /* where all planes meet, and the ends of an edge there */
    HEWN_SEARCH_LEAVE, /* a corner beyond a face of the cell */
    HEWN_SEARCH_PAIR,  /* where two of three surfaces meet */
    HEWN_SEARCH_SHARP, /* on both sides of the vertex */
    HEWN_SEARCH_DONE,
    HEWN_SEARCH_LOOK /* only how the surface is there */
} hewn_search_phase;

typedef struct hewn_search {
    hewn_host_cell cell;
    hewn_qef qef;
    hewn_qef_solution solved;
    vec usual;        /* the crossings' mean normal */
    vec corner;       /* beyond the cell */
    vec aside;        /* from the vertex towards the plane that bends away most */
    uint32_t sets[3]; /* planes of each surface */
    hewn_search_phase phase;
    uint32_t known; /* planes that crossings saw */
    uint32_t rounds, pair, trials;
    bool alone; /* the cell has no other loop */
    bool free;  /* and so the vertex need not give way */
    /* The vertex so far: */
    vec at, seen;         /* and the surface from there: unit normal, and how far off it is in cells */
    uint32_t rank, found; /* planes that no crossing saw */
    bool missed;          /* a corner is where no vertex can be */
    bool sharp;
} hewn_search;

/* Begins with the cell and the planes that are there. */
void hewn_search_begin(hewn_search *search, bool alone, vec usual);

/* A vertex that stays at the mean of the crossings. */
void hewn_search_begin_at_mean(hewn_search *search);

/* Prepares the next questions, and says how many there are: 0 where it is done. */
uint32_t hewn_search_next(hewn_search *search);

/* The questions: places in the cell's units. Returns how many. */
uint32_t hewn_search_ask(const hewn_search *search, vec asked[HEWN_SEARCH_QUESTIONS]);

/* The answers to them: the surface as seen from each place. */
void hewn_search_take(hewn_search *search, const struct hewn_grid *grid, const vec *told);

#endif
