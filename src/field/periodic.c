/* Triply periodic surfaces by the usual sums of sines and cosines, and sums of noise. A surface's sum is divided by how
 * steep it is at most, so that the field is 1-Lipschitz: its value is never more than the distance. */
#include "field/compose.h"

/* --- surfaces -------------------------------------------------------------------------------------------------------
 */

/* Sines and cosines of the three coordinates and of their doubles. */
typedef struct waves {
    hewn_field *f;
    hewn_node s[3], c[3], ss[3], cc[3];
} waves;

static waves waves_of(hewn_field *f, double period)
{
    waves out = {.f = f};
    hewn_node axis[3] = {hewn_x(f), hewn_y(f), hewn_z(f)};
    for (int i = 0; i < 3; i++) {
        hewn_node angle = times(f, axis[i], 2 * acos(-1) / period), twice = times(f, axis[i], 4 * acos(-1) / period);
        out.s[i] = hewn_sin(f, angle);
        out.c[i] = hewn_cos(f, angle);
        out.ss[i] = hewn_sin(f, twice);
        out.cc[i] = hewn_cos(f, twice);
    }
    return out;
}

static hewn_node of_three(const waves *w, hewn_node a, hewn_node b, hewn_node c)
{
    return hewn_mul(w->f, hewn_mul(w->f, a, b), c);
}

static hewn_node sum_of_three(const waves *w, hewn_node a, hewn_node b, hewn_node c)
{
    return hewn_add(w->f, hewn_add(w->f, a, b), c);
}

/* a_x b_y + a_y b_z + a_z b_x */
static hewn_node ring_of_two(const waves *w, const hewn_node *a, const hewn_node *b)
{
    return sum_of_three(w, hewn_mul(w->f, a[0], b[1]), hewn_mul(w->f, a[1], b[2]), hewn_mul(w->f, a[2], b[0]));
}

/* a_x b_y c_z + a_y b_z c_x + a_z b_x c_y */
static hewn_node ring_of_three(const waves *w, const hewn_node *a, const hewn_node *b, const hewn_node *c)
{
    return sum_of_three(w, of_three(w, a[0], b[1], c[2]), of_three(w, a[1], b[2], c[0]), of_three(w, a[2], b[0], c[1]));
}

/* `steepest` is not below the greatest slope where the period is a whole turn. */
static hewn_node surface(const waves *w, const char *name, hewn_node sum, double steepest, double period,
                         double thickness)
{
    if (!(thickness >= 0) || !isfinite(thickness))
        return hewn_field_refuse(w->f, HEWN_INVALID_ARGUMENT, "%s: the thickness %g must be finite and not below 0",
                                 name, thickness);
    hewn_node out = times(w->f, sum, period / (2 * acos(-1) * steepest));
    return thickness > 0 ? hewn_shell(w->f, out, thickness) : out;
}

hewn_node hewn_gyroid(hewn_field *f, double period, double thickness)
{
    if (!all_above_0(f, "gyroid", 1, &period))
        return HEWN_NODE_NONE;
    waves w = waves_of(f, period);
    return surface(&w, "gyroid", ring_of_two(&w, w.s, w.c), 1.7321, period, thickness);
}

hewn_node hewn_schwarz_p(hewn_field *f, double period, double thickness)
{
    if (!all_above_0(f, "schwarz_p", 1, &period))
        return HEWN_NODE_NONE;
    waves w = waves_of(f, period);
    return surface(&w, "schwarz_p", sum_of_three(&w, w.c[0], w.c[1], w.c[2]), 1.7321, period, thickness);
}

hewn_node hewn_schwarz_d(hewn_field *f, double period, double thickness)
{
    if (!all_above_0(f, "schwarz_d", 1, &period))
        return HEWN_NODE_NONE;
    waves w = waves_of(f, period);
    hewn_node sum = hewn_add(f, of_three(&w, w.s[0], w.s[1], w.s[2]), ring_of_three(&w, w.s, w.c, w.c));
    return surface(&w, "schwarz_d", sum, 1.7321, period, thickness);
}

hewn_node hewn_neovius(hewn_field *f, double period, double thickness)
{
    if (!all_above_0(f, "neovius", 1, &period))
        return HEWN_NODE_NONE;
    waves w = waves_of(f, period);
    hewn_node sum = hewn_add(f, times(f, sum_of_three(&w, w.c[0], w.c[1], w.c[2]), 3),
                             times(f, of_three(&w, w.c[0], w.c[1], w.c[2]), 4));
    return surface(&w, "neovius", sum, 7.001, period, thickness);
}

hewn_node hewn_lidinoid(hewn_field *f, double period, double thickness)
{
    if (!all_above_0(f, "lidinoid", 1, &period))
        return HEWN_NODE_NONE;
    waves w = waves_of(f, period);
    hewn_node sum = hewn_sub(f, ring_of_three(&w, w.ss, w.c, w.s), ring_of_two(&w, w.cc, w.cc));
    return surface(&w, "lidinoid", plus(f, times(f, sum, 0.5), 0.15), 2.611, period, thickness);
}

hewn_node hewn_iwp(hewn_field *f, double period, double thickness)
{
    if (!all_above_0(f, "iwp", 1, &period))
        return HEWN_NODE_NONE;
    waves w = waves_of(f, period);
    hewn_node sum = hewn_sub(f, times(f, ring_of_two(&w, w.c, w.c), 2), sum_of_three(&w, w.cc[0], w.cc[1], w.cc[2]));
    return surface(&w, "iwp", sum, 5.22, period, thickness);
}

hewn_node hewn_frd(hewn_field *f, double period, double thickness)
{
    if (!all_above_0(f, "frd", 1, &period))
        return HEWN_NODE_NONE;
    waves w = waves_of(f, period);
    hewn_node sum = hewn_sub(f, times(f, of_three(&w, w.c[0], w.c[1], w.c[2]), 4), ring_of_two(&w, w.cc, w.cc));
    return surface(&w, "frd", sum, 7.075, period, thickness);
}

hewn_node hewn_fischer_koch_s(hewn_field *f, double period, double thickness)
{
    if (!all_above_0(f, "fischer_koch_s", 1, &period))
        return HEWN_NODE_NONE;
    waves w = waves_of(f, period);
    return surface(&w, "fischer_koch_s", ring_of_three(&w, w.cc, w.s, w.c), 2.456, period, thickness);
}

/* --- noise ----------------------------------------------------------------------------------------------------------
 */

hewn_node hewn_noise(hewn_field *f, hewn_noise_kind kind, double size, uint32_t seed)
{
    if (!all_above_0(f, "noise", 1, &size))
        return HEWN_NODE_NONE;
    if ((unsigned)kind > HEWN_NOISE_CELLULAR)
        return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "noise: there is no such kind");
    hewn_node_data data = {.op = HEWN_OP_NOISE_VALUE + (hewn_op)kind, .parameter = {seed}};
    for (int i = 0; i < 3; i++) {
        double row[4] = {0};
        row[i] = 1 / size;
        data.operand[i] = affine(f, hewn_x(f), hewn_y(f), hewn_z(f), row).id;
    }
    hewn_node out = hewn_field_add_node(f, &data);
    return kind == HEWN_NOISE_CELLULAR ? plus(f, times(f, hewn_sqrt(f, out), 2), -1) : out;
}

typedef enum folding { AS_IT_IS, RIDGED, BILLOW } folding;

/* Octaves of ever finer noise, over the sum of their weights. */
static hewn_node octaves_of(hewn_field *f, const char *name, const hewn_octaves *o, folding fold)
{
    double gain = o->gain == 0 ? 0.5 : o->gain, lacunarity = o->lacunarity == 0 ? 2 : o->lacunarity;
    if (!all_above_0(f, name, 3, (const double[3]){o->size, gain, lacunarity}))
        return HEWN_NODE_NONE;
    if (o->octaves < 1 || o->octaves > 16)
        return hewn_field_refuse(f, HEWN_INVALID_ARGUMENT, "%s: it has 1 to 16 octaves, not %u", name, o->octaves);
    hewn_node sum = HEWN_NODE_NONE;
    double weight = 1, all = 0, size = o->size;
    for (unsigned i = 0; i < o->octaves; i++) {
        hewn_node one = hewn_noise(f, o->kind, size, (o->seed + i) % 0x1000000u);
        if (fold == RIDGED)
            one = plus(f, times(f, hewn_abs(f, one), -2), 1);
        if (fold == BILLOW)
            one = plus(f, times(f, hewn_abs(f, one), 2), -1);
        one = times(f, one, weight);
        sum = i == 0 ? one : hewn_add(f, sum, one);
        all += weight;
        weight *= gain;
        size /= lacunarity;
    }
    return times(f, sum, 1 / all);
}

hewn_node hewn_fbm(hewn_field *f, const hewn_octaves *octaves)
{
    return octaves_of(f, "fbm", octaves, AS_IT_IS);
}

hewn_node hewn_ridged(hewn_field *f, const hewn_octaves *octaves)
{
    return octaves_of(f, "ridged", octaves, RIDGED);
}

hewn_node hewn_billow(hewn_field *f, const hewn_octaves *octaves)
{
    return octaves_of(f, "billow", octaves, BILLOW);
}
