#include "iso/lattice_pen.h"

#include <math.h>
#include <string.h>

static void put_position(hewn_lattice_pen *pen, const double at[3])
{
    const double *m = pen->lattice->place;
    for (int i = 0; i < 3; i++)
        pen->position[i] = (float)(m[4 * i] * at[0] + m[4 * i + 1] * at[1] + m[4 * i + 2] * at[2] + m[4 * i + 3]);
    pen->position += 3;
}

/* `fallback` is an outward direction along the edge's axis, for where samples have no slope. */
static void put_normal(hewn_lattice_pen *pen, const double gradient[3], double fallback)
{
    const double *m = pen->lattice->turn;
    double normal[3], most = 0, sum = 0;
    for (int i = 0; i < 3; i++) {
        normal[i] = m[3 * i] * gradient[0] + m[3 * i + 1] * gradient[1] + m[3 * i + 2] * gradient[2];
        most = fmax(most, fabs(normal[i]));
    }
    if (!(most > 0)) {
        most = 0;
        for (int i = 0; i < 3; i++) {
            normal[i] = fallback * m[3 * i + (int)pen->axis];
            most = fmax(most, fabs(normal[i]));
        }
    }
    for (int i = 0; i < 3; i++) {
        normal[i] /= most;
        sum += normal[i] * normal[i];
    }
    sum = 1 / sqrt(sum);
    for (int i = 0; i < 3; i++)
        pen->normal[i] = (float)(normal[i] * sum);
    pen->normal += 3;
}

void hewn_lattice_put_cap(hewn_lattice_pen *pen, const uint32_t at[3], bool end)
{
    const hewn_lattice *lattice = pen->lattice;
    double place[3] = {at[0], at[1], at[2]}, none[3] = {0};
    place[pen->axis] += end ? lattice->margin : -lattice->margin;
    put_position(pen, place);
    /* turn makes outward directions of gradients: above, the outside is where values fall. */
    if (lattice->normals)
        put_normal(pen, none, end == lattice->above ? -1 : 1);
}

/* Cosine of the angle between gradients that are far apart. */
static const double BENT = 0.9;

void hewn_lattice_follow_bend(const hewn_lattice *lattice, uint32_t axis, double here, double there, double *share,
                              double first[3], double last[3])
{
    double both = 0, sizes[2] = {0};
    for (int a = 0; a < 3; a++) {
        both += first[a] * last[a];
        sizes[0] += first[a] * first[a];
        sizes[1] += last[a] * last[a];
    }
    if (!(both < BENT * sqrt(sizes[0]) * sqrt(sizes[1])))
        return;
    const double up = first[axis], down = last[axis], bend = (there - here - down) / (up - down);
    if (!(bend > 0 && bend < 1))
        return;
    const double value = here + bend * up;
    const bool before = (value < 0) != (here < 0);
    const double at = before ? here / (here - value) * bend : 1 - there / (there - value) * (1 - bend);
    if (!(at > 0 && at < 1))
        return;
    *share = at < lattice->margin ? lattice->margin : at > 1 - lattice->margin ? 1 - lattice->margin : at;
    memcpy(before ? last : first, before ? first : last, 3 * sizeof *first);
}

void hewn_lattice_put_edge(hewn_lattice_pen *pen, const uint32_t from[3], double share, bool inside,
                           const double first[3], const double last[3])
{
    double place[3] = {from[0], from[1], from[2]}, gradient[3];
    place[pen->axis] += share;
    put_position(pen, place);
    if (!pen->lattice->normals)
        return;
    for (int a = 0; a < 3; a++)
        gradient[a] = first[a] + share * (last[a] - first[a]);
    put_normal(pen, gradient, inside == pen->lattice->above ? -1 : 1);
}
