#include "app/file_arguments.h"
#include "app/voxelize_arguments.h"

static const hewn_option options[] = {
    {'o', "output", "FILE",
     "Write the volume to FILE; its extension (.vdb, .nrrd) names the format. `-` is standard output, with --to. "
     "Required."},
    HEWN_OPTIONS_VOXELIZE,
    HEWN_OPTION_MOST_SAMPLES,
    {0, "unit", "UNIT", "A mesh is in UNIT: m, cm, mm, um, km, in or ft. Default: what the file says."},
    {0, "from", "FORMAT",
     "Read the file as lua or vm, or as a mesh in glb, gltf, obj, ply, stl or off. Default: by its extension; needed "
     "where it is `-`."},
    {0, "to", "FORMAT", "Write the volume as vdb or nrrd. Default: by the output's extension."},
    HEWN_OPTION_REPORT,
    HEWN_OPTION_QUIET,
    HEWN_OPTION_HELP,
};

const hewn_command hewn_command_voxelize = {
    .name = "voxelize",
    .summary = "sample the distance to a mesh or a scene into a volume",
    .usage = "MESH|SCENE -o FILE.vdb|FILE.nrrd [OPTION]...",
    .about = "Writes signed distances, negative inside, at the points of a lattice: as a\n"
             "narrow band around the surface, which .vdb files hold sparsely, or with --dense\n"
             "all of them. Distances to a mesh (.glb, .gltf, .obj, .ply, .stl, .off, also with\n"
             ".gz) are exact. What is inside is told by winding numbers, so it may have holes,\n"
             "pass through itself, or be inside out; how sure that is, is told as confidence.\n"
             "Of a scene (.lua, .vm) the values of its field are written. Needs no device.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .after = "Examples:\n"
             "  hewn voxelize scan.stl -o scan.vdb --cell 0.5\n"
             "  hewn voxelize part.obj -o part.nrrd --cell 0.01 --dense\n"
             "  hewn voxelize gyroid.lua -o gyroid.vdb --cell 0.02 -D period=0.5\n",
    .run = hewn_voxelize_run,
};
