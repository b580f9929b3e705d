#include <stdio.h>
#include <string.h>

#include "app/app.h"
#include "app/certificate.h"
#include "app/file_arguments.h"
#include "app/path_arguments.h"
#include "base/error.h"
#include "hewn/check.h"
#include "pipeline/examine.h"

static const hewn_option options[] = {
    {0, "require", "LIST",
     "Fail with exit code 1 unless all of LIST hold: closed, manifold, oriented, no-self-intersections, "
     "no-degenerate-faces, no-duplicate-faces, no-isolated-vertices, one-component, positive-volume; with commas "
     "between."},
    {0, "no-self-intersections", NULL, "Do not count self-intersections, which takes the longest."},
    {0, "against", "FILE",
     "Tell also how far the surface is from that of another mesh file: the two-sided Hausdorff distance, proven for "
     "all "
     "points of both."},
    {0, "json", NULL, "Print JSON."},
    HEWN_OPTION_FROM,
    HEWN_OPTION_QUIET,
    HEWN_OPTION_HELP,
};

static hewn_result read_request(const hewn_arguments *arguments, hewn_examination *job, hewn_error *error)
{
    const char *from = hewn_arguments_value(arguments, "from");
    const char *require = hewn_arguments_value(arguments, "require");
    HEWN_TRY(hewn_input_argument_read(arguments, &job->path, error));
    job->against = hewn_arguments_value(arguments, "against");
    if (job->against && !job->against[0])
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a file needs a name");
    if (job->against && strcmp(job->against, "-") == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--against takes a file, not standard input");
    if (from)
        HEWN_TRY(hewn_format_parse(from, "--from", &job->format, error));
    if (require) {
        hewn_error reason;
        if (hewn_requirements_parse(require, &job->required, &reason) != HEWN_OK)
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--require: %s", reason.message);
    }
    job->skip_self_intersections = hewn_arguments_has(arguments, "no-self-intersections");
    if (job->skip_self_intersections && (job->required & HEWN_REQUIRE_NO_SELF_INTERSECTIONS))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "--no-self-intersections does not look at what --require no-self-intersections asks");
    return HEWN_OK;
}

static void print_text(const hewn_examination *job)
{
    const hewn_check *check = job->check;
    printf("%s: %llu vertices, %llu faces%s%s\n", strcmp(job->path, "-") == 0 ? "standard input" : job->path,
           (unsigned long long)check->vertex_count, (unsigned long long)check->face_count,
           job->model.unit ? ", in " : "", job->model.unit ? job->model.unit->name : "");
    hewn_certificate_print(check, stdout);
    if (job->against)
        printf("distance               at most %.6g, at least %.6g: %.6g from here to %s, %.6g back\n",
               job->distance.high, job->distance.low, job->distance.there, job->against, job->distance.back);
}

/* Says what does not hold, in one line; the exit code. */
static int judge(const hewn_examination *job)
{
    uint32_t unmet = hewn_check_unmet(job->check, job->required);
    const char *between = ": not met: ";
    if (!unmet)
        return 0;
    fflush(stdout);
    fprintf(stderr, "hewn: %s", strcmp(job->path, "-") == 0 ? "standard input" : job->path);
    for (uint32_t bit = 1; bit & HEWN_REQUIRE_ALL; bit <<= 1) {
        if (!(unmet & bit))
            continue;
        fprintf(stderr, "%s%s (", between, hewn_requirement_name((hewn_requirement)bit));
        hewn_certificate_explain(job->check, (hewn_requirement)bit, stderr);
        fputc(')', stderr);
        between = ", ";
    }
    fputc('\n', stderr);
    return HEWN_EXIT_UNMET;
}

static int run(const hewn_command *command, const hewn_arguments *arguments)
{
    hewn_error error = {0};
    hewn_examination job = {.began = hewn_started()};
    hewn_result result = read_request(arguments, &job, &error);
    if (result != HEWN_OK)
        return hewn_report_misuse(command, &error);
    bool quiet = hewn_arguments_has(arguments, "quiet"), json = hewn_arguments_has(arguments, "json");
    hewn_signals_catch();
    hewn_progress progress = hewn_progress_begin(quiet);
    job.progress = &progress;
    result = hewn_examine(&job, &error);
    hewn_progress_end();
    if (result == HEWN_OK && json)
        result = hewn_examination_write(&job, "-", &error);
    else if (result == HEWN_OK && !quiet)
        print_text(&job);
    int code = result == HEWN_OK ? judge(&job) : hewn_report_misuse(command, &error);
    hewn_examination_clear(&job);
    return code;
}

const hewn_command hewn_command_check = {
    .name = "check",
    .summary = "prove what a mesh file is, and what is wrong with it",
    .usage = "FILE [OPTION]...",
    .about = "Reads a mesh (.glb, .gltf, .obj, .ply, .stl, .off, also with .gz) and tells\n"
             "whether it is closed, manifold and oriented, with exact counts of what is not:\n"
             "boundary, non-manifold and unoriented edges, degenerate and duplicate faces,\n"
             "pairs of faces that intersect; and components, genus, volume, area and bounds.\n"
             "Faces are numbered from 0. Vertices are one where the file shares them; in STL,\n"
             "which shares none, where they lie at one place.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .after = "Examples:\n"
             "  hewn check part.stl\n"
             "  hewn check part.glb --quiet --require closed,manifold,oriented\n"
             "  hewn check scan.ply.gz --json --no-self-intersections > scan.json\n"
             "  hewn check small.glb --against scan.ply\n",
    .run = run,
};
