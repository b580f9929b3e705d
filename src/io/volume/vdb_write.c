/* OpenVDB's level sets: a leaf for each brick that has samples within the band. */
#include <math.h>

#include "base/error.h"
#include "base/progress.h"
#include "io/shim/module.h"
#include "io/shim/vdb.h"
#include "io/volume/sampling_write.h"

enum { BRICK = HEWN_SAMPLING_BRICK, SIDE = HEWN_SAMPLING_SIDE };

typedef struct giver {
    hewn_sampling_writing *job;
    hewn_sampling_written *out;
    uint64_t brick, brick_count;
    hewn_result result;
    hewn_error *error;
} giver;

/* A brick's first 8 x 8 x 8 samples, as OpenVDB orders them: z fastest. */
static bool fill_leaf(giver *own, uint64_t brick, float values[HEWN_VDB_LEAF], uint8_t active[HEWN_VDB_LEAF],
                      const int32_t origin[3])
{
    const hewn_sampling *s = own->job->sampling;
    const float *samples = hewn_sampling_brick(s, brick);
    double band = own->job->band, cell = own->job->place->cell;
    uint64_t count = 0;
    if (!samples && !own->job->dense)
        return false;
    for (int n = 0; n < HEWN_VDB_LEAF; n++) {
        const int at[3] = {n >> 6, n >> 3 & 7, n & 7};
        double cells[3];
        for (int i = 0; i < 3; i++)
            cells[i] = origin[i] + at[i] - 0.5 * s->cells[i];
        double value =
            samples ? (double)samples[at[0] + SIDE * (at[1] + SIDE * at[2])] : hewn_sampling_value(s, cells, NULL);
        active[n] = own->job->dense || fabs(value) < band;
        count += active[n];
        if (!active[n])
            value = value < 0 ? -band : band;
        values[n] = (float)(value * cell);
    }
    own->out->active += count;
    return count > 0;
}

/* Called by the module until it returns false. */
static bool next_leaf(void *user, int32_t origin[3], float values[HEWN_VDB_LEAF], uint8_t active[HEWN_VDB_LEAF])
{
    giver *own = user;
    const hewn_sampling *s = own->job->sampling;
    for (; own->brick < own->brick_count; own->brick++) {
        if (own->brick % 4096 == 0 && own->result == HEWN_OK)
            own->result = hewn_progress_report(own->job->progress, "write",
                                               0.5 * (double)own->brick / (double)own->brick_count, own->error);
        if (own->result != HEWN_OK)
            return false;
        origin[0] = (int32_t)(BRICK * (own->brick % s->bricks[0]));
        origin[1] = (int32_t)(BRICK * (own->brick / s->bricks[0] % s->bricks[1]));
        origin[2] = (int32_t)(BRICK * (own->brick / ((uint64_t)s->bricks[0] * s->bricks[1])));
        if (!fill_leaf(own, own->brick, values, active, origin))
            continue;
        own->brick++;
        own->out->leaves++;
        return true;
    }
    return false;
}

static bool take_bytes(void *user, const char *bytes, size_t length)
{
    giver *own = user;
    own->job->written += length;
    if (own->result == HEWN_OK)
        own->result = hewn_output_write(own->job->output, bytes, length, own->error);
    return own->result == HEWN_OK;
}

hewn_result hewn_vdb_write(hewn_sampling_writing *job, hewn_sampling_written *out, hewn_error *error)
{
    char message[512] = "";
    const hewn_vdb_module *module = hewn_module_load("hewn_vdb", message, sizeof message);
    if (!module)
        return hewn_fail(error, HEWN_MISSING_FEATURE, "%s", message);
    const hewn_sampling *s = job->sampling;
    giver own = {
        .job = job, .out = out, .brick_count = (uint64_t)s->bricks[0] * s->bricks[1] * s->bricks[2], .error = error};
    const double greatest = fmax(fabs((double)s->least), fabs((double)s->greatest));
    const hewn_vdb_level_set what = {.name = "surface",
                                     .unit = job->unit ? job->unit->name : NULL,
                                     .origin = {job->place->origin[0], job->place->origin[1], job->place->origin[2]},
                                     .cell = job->place->cell,
                                     .background = (job->dense ? greatest : job->band) * job->place->cell,
                                     .next = next_leaf,
                                     .take = take_bytes,
                                     .user = &own};
    hewn_vdb_result result = module->write(&what, message, sizeof message);
    HEWN_TRY(own.result);
    if (result == HEWN_VDB_OK)
        return hewn_progress_report(job->progress, "write", 1, error);
    return hewn_fail(error, result == HEWN_VDB_OUT_OF_MEMORY ? HEWN_OUT_OF_MEMORY : HEWN_IO, "%s", message);
}
