#include <stdio.h>

#include "app/app.h"
#include "base/error.h"
#include "base/json.h"

static const hewn_option options[] = {
    {0, "json", NULL, "Print JSON."},
    {'h', "help", NULL, "Print this help."},
};

static const char *kind_name(hewn_device_kind kind)
{
    switch (kind) {
    case HEWN_DEVICE_DISCRETE: return "discrete";
    case HEWN_DEVICE_INTEGRATED: return "integrated";
    case HEWN_DEVICE_VIRTUAL: return "virtual";
    case HEWN_DEVICE_CPU: return "cpu";
    case HEWN_DEVICE_OTHER: break;
    }
    return "other";
}

/* Bytes in the largest binary unit of which there is at least one. */
static void print_bytes(const char *name, uint64_t bytes)
{
    static const char *const units[] = {"B", "KiB", "MiB", "GiB", "TiB"};
    double amount = (double)bytes;
    int unit = 0;
    for (; amount >= 1024 && unit < 4; ++unit)
        amount /= 1024;
    printf("     %-26s %.4g %s\n", name, amount, units[unit]);
}

static void print_device(const hewn_device_info *info)
{
    printf("%-3u  %s\n", info->index, info->name);
    printf("     %-26s %s\n", "kind", kind_name(info->kind));
    printf("     %-26s %s\n", "driver", info->driver);
    printf("     %-26s %u.%u.%u\n", "Vulkan", info->api_version[0], info->api_version[1], info->api_version[2]);
    printf("     %-26s %u\n", "subgroup size", info->subgroup_size);
    printf("     %-26s %u\n", "workgroups along x", info->max_workgroup_count);
    printf("     %-26s %u\n", "invocations a workgroup", info->max_workgroup_invocations);
    print_bytes("shared memory a workgroup", info->max_shared_memory);
    print_bytes("largest allocation", info->max_allocation);
    print_bytes("largest storage buffer", info->max_storage_buffer_range);
    print_bytes("memory", info->memory);
    if (info->usable)
        printf("     %-26s yes\n", "usable");
    else
        printf("     %-26s no, it lacks %s\n", "usable", info->missing);
}

static void json_device(hewn_json *json, const hewn_device_info *info)
{
    hewn_json_object(json, NULL);
    hewn_json_unsigned(json, "index", info->index);
    hewn_json_string(json, "name", info->name);
    hewn_json_string(json, "driver", info->driver);
    hewn_json_string(json, "kind", kind_name(info->kind));
    hewn_json_array(json, "api_version");
    for (int i = 0; i < 3; ++i)
        hewn_json_unsigned(json, NULL, info->api_version[i]);
    hewn_json_end_array(json);
    hewn_json_bool(json, "usable", info->usable);
    hewn_json_string(json, "missing", info->usable ? NULL : info->missing);
    hewn_json_object(json, "limits");
    hewn_json_unsigned(json, "subgroup_size", info->subgroup_size);
    hewn_json_unsigned(json, "max_workgroup_count", info->max_workgroup_count);
    hewn_json_unsigned(json, "max_workgroup_invocations", info->max_workgroup_invocations);
    hewn_json_unsigned(json, "max_shared_memory", info->max_shared_memory);
    hewn_json_unsigned(json, "max_allocation", info->max_allocation);
    hewn_json_unsigned(json, "max_storage_buffer_range", info->max_storage_buffer_range);
    hewn_json_unsigned(json, "memory", info->memory);
    hewn_json_end_object(json);
    hewn_json_end_object(json);
}

static hewn_result print_json(const hewn_device_info *infos, size_t count, hewn_error *error)
{
    hewn_text text = {0};
    hewn_json json = hewn_json_begin(&text);
    hewn_json_object(&json, NULL);
    hewn_json_string(&json, "version", hewn_version());
    hewn_json_array(&json, "devices");
    for (size_t i = 0; i < count; ++i)
        json_device(&json, &infos[i]);
    hewn_json_end_array(&json);
    hewn_json_end_object(&json);
    hewn_result result = hewn_text_status(&text, error);
    if (result == HEWN_OK)
        fwrite(text.bytes, 1, text.length, stdout);
    hewn_text_clear(&text);
    return result;
}

static int run(const hewn_command *command, const hewn_arguments *arguments)
{
    hewn_error error = {0};
    if (arguments->operand_count > 0) {
        hewn_fail(&error, HEWN_INVALID_ARGUMENT, "there is nothing to do with '%s'", arguments->operands[0]);
        return hewn_report_misuse(command, &error);
    }
    hewn_device_info *infos = NULL;
    size_t count = 0;
    hewn_result result = hewn_device_list(&infos, &count, &error);
    if (result == HEWN_OK && hewn_arguments_has(arguments, "json"))
        result = print_json(infos, count, &error);
    else if (result == HEWN_OK)
        for (size_t i = 0; i < count; ++i)
            print_device(&infos[i]);
    if (result == HEWN_OK && count == 0)
        fprintf(stderr, "hewn: note: the Vulkan loader knows no device; is a driver installed?\n");
    hewn_device_list_free(&infos);
    return result == HEWN_OK ? 0 : hewn_report_failure(&error);
}

const hewn_command hewn_command_devices = {
    .name = "devices",
    .summary = "list the devices that can compute",
    .usage = "[OPTION]...",
    .about = "Lists the Vulkan devices of this machine with their limits, best first. The\n"
             "number before a name, or a part of the name, is what --device and $HEWN_DEVICE\n"
             "take.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .after = "Example:\n"
             "  hewn devices --json\n",
    .run = run,
};
