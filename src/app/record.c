#include "app/record.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static const char *input_name(const char *path)
{
    return strcmp(path, "-") == 0 ? "standard input" : path;
}

static const char *output_name(const char *path)
{
    return strcmp(path, "-") == 0 ? "standard output" : path;
}

static void print_unit(const hewn_conversion *done)
{
    if (!done->unit_after)
        fprintf(stderr, "unit unknown");
    else if (done->unit_assumed)
        fprintf(stderr, "unit %s (assumed)", done->unit_after->name);
    else if (done->unit_before == done->unit_after)
        fprintf(stderr, "unit %s", done->unit_after->name);
    else
        fprintf(stderr, "unit %s -> %s (times %" PRIu64 "/%" PRIu64 ")", done->unit_before->name,
                done->unit_after->name, done->scale_numerator, done->scale_denominator);
}

static void print_up(const hewn_file_report *report)
{
    const hewn_conversion *done = &report->conversion;
    const int8_t *r = done->rotation;
    if (!report->up_known)
        fprintf(stderr, "up unknown");
    else if (done->up_assumed)
        fprintf(stderr, "up %s (assumed)", hewn_axis_name(done->up_after));
    else if (done->up_before == done->up_after)
        fprintf(stderr, "up %s", hewn_axis_name(done->up_after));
    else
        fprintf(stderr, "up %s -> %s (turned by [%d %d %d; %d %d %d; %d %d %d])", hewn_axis_name(done->up_before),
                hewn_axis_name(done->up_after), r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8]);
}

void hewn_record_print(const hewn_file_report *report)
{
    fprintf(stderr, "%s -> %s: %" PRIu64 " vertices, %" PRIu64 " faces; ", input_name(report->input),
            output_name(report->output), report->vertices, report->faces);
    print_unit(&report->conversion);
    fputs("; ", stderr);
    print_up(report);
    fputc('\n', stderr);
}

/* "1 vertex", "2 vertices": what `one` and `many` call them. */
static void print_number(uint64_t count, const char *one, const char *many)
{
    fprintf(stderr, "%" PRIu64 " %s", count, count == 1 ? one : many);
}

static void print_losses(const hewn_file_report *report)
{
    static const char *const names[] = {
        [HEWN_MESH_GLB] = "GLB", [HEWN_MESH_OBJ] = "OBJ", [HEWN_MESH_PLY] = "PLY", [HEWN_MESH_STL] = "STL",
        [HEWN_MESH_OFF] = "OFF", [HEWN_MESH_3MF] = "3MF", [HEWN_MESH_HPM] = "HPM"};
    const hewn_file_losses *lost = &report->losses;
    const char *between = "";
    if (!lost->cut_faces && !lost->channel_count && !lost->rounded && !lost->isolated && !lost->rejoined)
        return;
    fprintf(stderr, "hewn: note: not kept by %s: ", names[report->to]);
    if (lost->cut_faces) {
        print_number(lost->cut_faces, "polygon, cut into triangles", "polygons, cut into triangles");
        between = "; ";
    }
    for (uint32_t i = 0; i < lost->channel_count; i++) {
        fprintf(stderr, "%s%s", i == 0 ? between : ", ", lost->channels[i]);
        between = "; ";
    }
    if (lost->rounded) {
        fprintf(stderr, "%sdouble precision (", between);
        print_number(lost->rounded, "vertex", "vertices");
        fprintf(stderr, " rounded to floats, by at most %.2g)", lost->rounding);
        between = "; ";
    }
    if (lost->isolated) {
        fputs(between, stderr);
        print_number(lost->isolated, "vertex without a face", "vertices without a face");
        between = "; ";
    }
    if (lost->rejoined) {
        fputs(between, stderr);
        print_number(lost->rejoined, "vertex that was split off", "vertices that were split off");
        fputs(" (a reader joins what lies at one place)", stderr);
    }
    fputc('\n', stderr);
}

void hewn_notes_print(const hewn_file_job_desc *desc, const hewn_file_report *report)
{
    if (desc->unit && report->file_unit && desc->unit != report->file_unit)
        fprintf(stderr, "hewn: note: --unit %s overrules the file, which says %s\n", desc->unit->name,
                report->file_unit->name);
    if (desc->up && report->file_up_known && *desc->up != report->file_up)
        fprintf(stderr, "hewn: note: --up %s overrules the file, which says %s\n", hewn_axis_name(*desc->up),
                hewn_axis_name(report->file_up));
    print_losses(report);
}
