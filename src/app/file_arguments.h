/* The parts of command lines that the commands for mesh files share: what to read and what it is in, what to write. */
#ifndef HEWN_SRC_APP_FILE_ARGUMENTS_H
#define HEWN_SRC_APP_FILE_ARGUMENTS_H

#include "app/options.h"
#include "hewn/file_job.h"

#define HEWN_OPTION_FROM                                                                                               \
    {                                                                                                                  \
        0, "from", "FORMAT",                                                                                           \
            "Read the file as glb, gltf, obj, ply, stl or off. Default: by its extension; needed where it is `-`."     \
    }
#define HEWN_OPTION_OUTPUT                                                                                             \
    {                                                                                                                  \
        'o', "output", "FILE",                                                                                         \
            "Write the mesh to FILE, which may be the one that is read; its extension (.glb, .obj, .ply, .stl, .off, " \
            ".3mf) "                                                                                                   \
            "names the format. `-` is standard output, with --to. Required."                                           \
    }
#define HEWN_OPTION_TO                                                                                                 \
    {                                                                                                                  \
        0, "to", "FORMAT", "Write the mesh as glb, obj, ply, stl, off or 3mf. Default: by the output's extension."     \
    }
#define HEWN_OPTIONS_FRAME                                                                                             \
    {0, "unit", "UNIT",                                                                                                \
     "The input is in UNIT: m, cm, mm, um, km, in or ft. Default: what the file says. Goes before what it says."},     \
        {0, "up", "AXIS", "The input has this axis up: +X, +Y or +Z. Default and rank as with --unit."},               \
        {0, "to-unit", "UNIT",                                                                                         \
         "Write in UNIT. Default: the input's; GLB is always in m. An input of unknown unit is taken to be in it."},   \
    {                                                                                                                  \
        0, "to-up", "AXIS",                                                                                            \
            "Write with this axis up. Default: the input's; GLB always has +Y, 3MF +Z. An input of unknown axes is "   \
            "taken to have it."                                                                                        \
    }
#define HEWN_OPTION_REPORT                                                                                             \
    {                                                                                                                  \
        0, "report", "FILE", "Write a report as JSON to FILE; `-` is standard output (not together with -o -)."        \
    }
#define HEWN_OPTION_QUIET                                                                                              \
    {                                                                                                                  \
        'q', "quiet", NULL, "Print errors only: no progress, no summary."                                              \
    }
#define HEWN_OPTION_HELP                                                                                               \
    {                                                                                                                  \
        'h', "help", NULL, "Print this help."                                                                          \
    }

/* A job's files and frames as the arguments say; `unit` and the like point into static tables, `axes` into itself, so
 * the struct stays where it is. */
typedef struct hewn_file_arguments {
    hewn_file_job_desc desc;
    hewn_axis up, to_up;
    bool quiet;
} hewn_file_arguments;

/* Takes the operand and all options above. HEWN_INVALID_ARGUMENT. */
hewn_result hewn_file_arguments_read(const hewn_arguments *arguments, hewn_file_arguments *out, hewn_error *error);

#endif
