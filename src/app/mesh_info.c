#include "app/mesh_info.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "app/app.h"
#include "app/certificate.h"
#include "base/alloc.h"
#include "base/error.h"
#include "pipeline/examine.h"
#include "pipeline/model_facts.h"

/* Named values that are listed; JSON has them all. */
enum { LISTED = 12 };

/* --- text -------------------------------------------------------------------------------------------------------- */

/* Names come from files, and nothing of a file may steer the terminal. */
static void print_name(const char *name)
{
    for (; *name; name++)
        putchar((unsigned char)*name < 0x20 || *name == 0x7f ? '?' : *name);
}

static void print_faces(const hewn_model *model, const hewn_model_facts *facts)
{
    printf("faces                  %" PRIu64, model->face_count);
    if (facts->triangles == model->face_count && model->face_count > 0)
        printf(", all triangles");
    else if (facts->quads == model->face_count && model->face_count > 0)
        printf(", all quads");
    else if (model->face_count > 0)
        printf(": %" PRIu64 " triangles, %" PRIu64 " quads, %" PRIu64 " polygons", facts->triangles, facts->quads,
               facts->polygons);
    if (facts->polygons > 0)
        printf(" of up to %" PRIu64 " corners", facts->most_corners);
    putchar('\n');
}

static hewn_result print_values(const hewn_model *model, const hewn_channel *channel, hewn_error *error)
{
    uint64_t *uses;
    HEWN_TRY(hewn_channel_uses(model, channel, &uses, error));
    for (uint32_t i = 0; i < channel->name_count && i < LISTED; i++) {
        printf("    %10" PRIu64 "  ", uses[i]);
        print_name(channel->names[i]);
        putchar('\n');
    }
    if (channel->name_count > LISTED)
        printf("                and %u more\n", channel->name_count - LISTED);
    hewn_free(uses);
    return HEWN_OK;
}

static hewn_result print_channel(const hewn_model *model, const hewn_channel *channel, hewn_error *error)
{
    printf("  %s ", hewn_domain_name(channel->info.domain));
    print_name(channel->info.name);
    printf(": %u %s", channel->info.components, hewn_scalar_name(channel->info.scalar));
    if (channel->name_count > 0) {
        printf(", %u name%s\n", channel->name_count, channel->name_count == 1 ? "" : "s");
        return print_values(model, channel, error);
    }
    for (uint32_t k = 0; k < channel->info.components; k++) {
        double lo, hi;
        hewn_channel_range(model, channel, k, &lo, &hi);
        printf("%s%.6g to %.6g", k == 0 ? ", " : "; ", lo, hi);
    }
    putchar('\n');
    return HEWN_OK;
}

static hewn_result print_mesh(const hewn_examination *job, hewn_error *error)
{
    const hewn_model *model = &job->model;
    hewn_model_facts facts = hewn_model_facts_of(model);
    printf("%s: mesh (%s)\n", strcmp(job->path, "-") == 0 ? "standard input" : job->path,
           hewn_mesh_format_name(job->format));
    printf("vertices               %" PRIu64 "\n", model->vertex_count);
    print_faces(model, &facts);
    printf("unit                   %s\n", model->unit ? model->unit->name : "unknown");
    printf("up                     %s\n", model->up_known ? hewn_axis_name(model->up) : "unknown");
    printf("attributes             %s\n", model->channel_count == 0 ? "none" : "");
    for (uint32_t i = 0; i < model->channel_count; i++)
        HEWN_TRY(print_channel(model, &model->channels[i], error));
    hewn_certificate_print(job->check, stdout);
    return HEWN_OK;
}

hewn_result hewn_mesh_tell(const char *path, hewn_mesh_format format, bool json, hewn_error *error)
{
    hewn_signals_catch();
    hewn_progress progress = hewn_progress_begin(false);
    hewn_examination job = {.path = path,
                            .format = format,
                            .skip_self_intersections = true,
                            .began = hewn_started(),
                            .progress = &progress};
    hewn_result result = hewn_examine(&job, error);
    hewn_progress_end();
    if (result == HEWN_OK)
        result = json ? hewn_examination_write(&job, "-", error) : print_mesh(&job, error);
    hewn_examination_clear(&job);
    return result;
}
