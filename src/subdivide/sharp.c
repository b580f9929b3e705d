#include "subdivide/sharp.h"

/* Chaikin's rule along creases (DeRose, Kass and Truong 1998, section 3): three quarters of an edge's own sharpness, a
 * quarter of the mean of the other semi-sharp edges at that end, less one. */
float hewn_sub_child_sharpness(const sub_level *level, uint32_t edge, uint32_t v, hewn_creasing creasing)
{
    float own = level->edge_sharp[edge], sum = 0;
    if (creasing == HEWN_CREASING_UNIFORM || own <= 0 || own >= SHARP_FOREVER)
        return sub_decrease(own);
    uint32_t others = 0;
    for (uint32_t i = level->vert_first[v]; i < level->vert_first[v + 1]; i++) {
        float other = level->edge_sharp[level->vert_edges[i]];
        if (level->vert_edges[i] == edge || other <= 0 || other >= SHARP_FOREVER)
            continue;
        sum += other;
        others++;
    }
    if (others > 0)
        own = 0.75f * own + 0.25f * sum / (float)others;
    return own > 1 ? own - 1 : 0;
}

/* By Chaikin's rule one end of an edge may stay sharp and the other not, though its own sharpness is above 1. The share
 * is that sharpness all the same, as in OpenSubdiv. */
double hewn_sub_edge_share(const sub_level *level, uint32_t edge, hewn_creasing creasing)
{
    float sharpness = level->edge_sharp[edge];
    if (sharpness <= 0 || sharpness >= SHARP_FOREVER)
        return sharpness > 0;
    if (creasing == HEWN_CREASING_UNIFORM)
        return sharpness < 1 ? (double)sharpness : 1;
    bool stays = hewn_sub_child_sharpness(level, edge, level->edge_verts[2 * (size_t)edge], creasing) > 0 &&
                 hewn_sub_child_sharpness(level, edge, level->edge_verts[2 * (size_t)edge + 1], creasing) > 0;
    return stays ? 1 : (double)sharpness;
}

static sub_rule rule_of(float vert_sharp, uint32_t sharp_edges)
{
    if (vert_sharp > 0 || sharp_edges > 2)
        return SUB_CORNER;
    return sharp_edges == 2 ? SUB_CREASE : sharp_edges == 1 ? SUB_DART : SUB_SMOOTH;
}

sub_vert_rule hewn_sub_rule_of(const sub_level *level, uint32_t v, hewn_creasing creasing)
{
    sub_vert_rule out = {SUB_SMOOTH, SUB_SMOOTH, {0, 0}, {0, 0}, 1};
    uint32_t sharp = 0, child_sharp = 0, ending = 0;
    float own = level->vert_sharp[v], child_own = sub_decrease(own), sum = 0;
    if (own > 0 && child_own <= 0) {
        ending = 1;
        sum = own;
    }
    for (uint32_t i = level->vert_first[v]; i < level->vert_first[v + 1]; i++) {
        uint32_t edge = level->vert_edges[i];
        float sharpness = level->edge_sharp[edge];
        if (sharpness <= 0)
            continue;
        uint32_t other = sub_other(level, edge, v);
        if (sharp < 2)
            out.ends[sharp] = other;
        sharp++;
        if (hewn_sub_child_sharpness(level, edge, v, creasing) > 0) {
            if (child_sharp < 2)
                out.child_ends[child_sharp] = other;
            child_sharp++;
        } else {
            ending++;
            sum += sharpness;
        }
    }
    out.rule = rule_of(own, sharp);
    out.child = rule_of(child_own, child_sharp);
    if (out.rule != out.child && ending > 0) {
        out.share = (double)sum / ending;
        out.share = out.share > 1 ? 1 : out.share;
    }
    return out;
}
