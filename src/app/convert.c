#include "app/file_arguments.h"
#include "app/file_command.h"
#include "app/label_command.h"
#include "app/simplify_arguments.h"
#include "app/smooth_arguments.h"
#include "app/volume_arguments.h"
#include "app/volume_convert.h"
#include "base/error.h"

static const hewn_option options[] = {
    HEWN_OPTION_OUTPUT,
    HEWN_OPTION_SIMPLIFY,
    HEWN_OPTION_SMOOTH,
    HEWN_OPTIONS_LABELS,
    HEWN_OPTIONS_FRAME,
    {0, "from", "FORMAT",
     "Read the file as a mesh in glb, gltf, obj, ply, stl or off, or as a volume in nifti, nrrd, metaimage, raw, npy, "
     "inr, tiff, vdb or dicom. Default: by its extension, else by how it begins; needed where FILE is `-`."},
    HEWN_OPTION_TO,
    HEWN_OPTIONS_VOLUME,
    HEWN_OPTIONS_VOLUME_MESH,
    HEWN_OPTION_REPORT,
    HEWN_OPTION_QUIET,
    HEWN_OPTION_HELP,
};

static hewn_result read(const hewn_arguments *arguments, hewn_file_steps *steps, hewn_file_job_desc *desc,
                        hewn_error *error)
{
    bool simplify;
    HEWN_TRY(hewn_simplify_target_read(arguments, &steps->simplify, &simplify, error));
    desc->simplify = simplify ? &steps->simplify : NULL;
    steps->simplify.measure = simplify && desc->report;
    const char *method = hewn_arguments_value(arguments, "smooth");
    if (hewn_volume_convert_any(arguments))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the options of volumes do not go with %s, which is a mesh",
                         desc->input);
    if (!method)
        return HEWN_OK;
    desc->smooth = &steps->smooth;
    return hewn_smooth_spec_parse(method, "--smooth", &steps->smooth, error);
}

static void print(const hewn_file_job_desc *desc, const hewn_file_report *report)
{
    if (desc->simplify)
        hewn_simplify_print(&report->simplify);
    if (desc->smooth)
        hewn_smooth_print(&report->smooth, report->smooth_method);
}

/* What has a mesh's extension is one, whatever it begins with. */
static int run(const hewn_command *command, const hewn_arguments *arguments)
{
    if (hewn_label_arguments_any(arguments))
        return hewn_label_command_run(command, arguments);
    hewn_volume_format format;
    const char *from = hewn_arguments_value(arguments, "from");
    bool is_mesh =
        !from && arguments->operand_count > 0 && hewn_mesh_format_of(arguments->operands[0]) != HEWN_MESH_UNKNOWN;
    if (!is_mesh && arguments->operand_count == 1 && hewn_volume_arguments_wanted(arguments, &format))
        return hewn_volume_convert_run(command, arguments, format);
    return hewn_file_command_run(command, arguments, &(hewn_file_command){read, print});
}

const hewn_command hewn_command_convert = {
    .name = "convert",
    .summary = "write a mesh in another format, unit or axes; mesh a volume",
    .usage = "FILE -o FILE [OPTION]...",
    .about = "Reads a mesh (.glb, .gltf, .obj, .ply, .stl, .off, also with .gz) and writes it\n"
             "as it is: polygons, order of vertices, attributes and double precision stay\n"
             "where the format can hold them, and what it cannot is named. Unit and axes\n"
             "change only as asked, or as the format demands; what was done is told exactly.\n"
             "\n"
             "Of a volume (.nii, .hdr, .nrrd, .nhdr, .mha, .mhd, .raw, .npy, .inr, .tif, .vdb,\n"
             ".dcm, also with .gz, or a folder of DICOM) it writes the surface at the iso\n"
             "value: closed, manifold and oriented for any samples, and proven so. The value\n"
             "used is told. Needs no device.\n"
             "\n"
             "With --labels the volume is one of labels, and the surface of each is written:\n"
             "all are made at once, closed and manifold, and neighbours fit without a gap. A\n"
             ".glb file has a node a label, .obj and .ply an object; for a file a label name a\n"
             "folder (-o DIR/) or a pattern (-o {name}.stl).\n"
             "\n"
             "What is asked for besides is done in this order: --smooth-volume, --largest,\n"
             "--min-volume, --fill-cavities, --smooth, --simplify. Lengths and volumes are in\n"
             "the input's unit, which is mm for a patient.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .after = "Examples:\n"
             "  hewn convert chair.obj --unit in --up +Z -o chair.glb\n"
             "  hewn convert part.stl --unit mm -o part.3mf\n"
             "  hewn convert scan.ply.gz -o - --to off | head -2\n"
             "  hewn convert head.nii.gz --iso otsu -o head.stl\n"
             "  hewn convert ct/ --iso hu:bone --space lps -o bone.obj\n"
             "  hewn convert head.nii.gz --smooth-volume 1 --largest 1 --fill-cavities \\\n"
             "    --smooth taubin:iterations=20 --simplify ratio:0.2 -o head.glb\n"
             "  hewn convert brain.nii.gz --labels all --names FreeSurferLUT.txt -o brain.glb\n"
             "  hewn convert seg.nrrd --labels 1,3 -o 'parts/{label}-{name}.stl'\n",
    .run = run,
};
