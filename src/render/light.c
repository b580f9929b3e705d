#include "render/light.h"

#include <math.h>

/* How near is on the surface, in pixels: thinner features may be missed. */
#define NEAR 0.02

hewn_stage hewn_stage_of(const hewn_lens *lens, const hewn_render_desc *desc, const hewn_box *box)
{
    int up = hewn_axis_index(desc->up);
    double light[3], length = 0, size = 0, farthest = 0;
    for (int i = 0; i < 3; i++) {
        light[i] = -0.75 * lens->forward[i] - 0.55 * lens->right[i] + 0.35 * lens->upward[i] + (i == up ? 0.75 : 0);
        length += light[i] * light[i];
        size += (box->hi[i] - box->lo[i]) * (box->hi[i] - box->lo[i]);
        farthest = fmax(farthest, fmax(fabs(box->lo[i]), fabs(box->hi[i])));
    }
    size = sqrt(size);
    double pixel = 2 * lens->half / lens->height;
    hewn_stage stage = {.softness = 0.12F, .reach = (float)(0.09 * size), .up = (uint32_t)up};
    for (int i = 0; i < 3; i++) {
        double part = light[i] / sqrt(length);
        stage.light[i] = fabs(part) < 1e-12 ? 1e-12F : (float)part;
    }
    stage.nearness = (float)fmax(lens->parallel ? NEAR * pixel : 0, 4e-7 * fmax(size, farthest));
    stage.spread = lens->parallel ? 0 : (float)(NEAR * pixel);
    return stage;
}

static void mix(const float a[3], const float b[3], float share, float out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[i] + (b[i] - a[i]) * share;
}

void hewn_met_colour(const hewn_met *met, const hewn_stage *stage, const float surface[3], float out[3])
{
    static const float background[3] = {0.84F, 0.87F, 0.91F}, sky[3] = {0.50F, 0.55F, 0.62F},
                       below[3] = {0.26F, 0.24F, 0.22F}, sun[3] = {0.95F, 0.90F, 0.82F};
    if (met->what == HEWN_MET_NOTHING) {
        mix(background, background, 0, out);
        return;
    }
    if (met->what == HEWN_MET_GROUND) { /* unshaded it is the background, so that it has no horizon */
        float left = (0.45F + 0.55F * met->light) * (0.25F + 0.75F * met->openness);
        for (int i = 0; i < 3; i++)
            out[i] = background[i] * left;
        return;
    }
    const float *n = met->normal, *light = stage->light;
    float facing = fmaxf(n[0] * light[0] + n[1] * light[1] + n[2] * light[2], 0.0F);
    float around[3];
    mix(below, sky, 0.5F + 0.5F * n[stage->up], around);
    for (int i = 0; i < 3; i++)
        out[i] = surface[i] * (around[i] * met->openness + sun[i] * facing * met->light);
}
