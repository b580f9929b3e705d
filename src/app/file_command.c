#include "app/file_command.h"

#include "app/file_arguments.h"
#include "app/record.h"

int hewn_file_command_run(const hewn_command *command, const hewn_arguments *arguments, const hewn_file_command *own)
{
    hewn_error error = {0};
    hewn_file_arguments file;
    hewn_file_steps steps = {0};
    hewn_result result = hewn_file_arguments_read(arguments, &file, &error);
    if (result == HEWN_OK)
        result = own->read(arguments, &steps, &file.desc, &error);
    if (result != HEWN_OK)
        return hewn_report_misuse(command, &error);
    hewn_signals_catch();
    hewn_progress progress = hewn_progress_begin(file.quiet);
    hewn_file_report report;
    file.desc.progress = &progress;
    file.desc.began = hewn_started();
    result = hewn_file_convert(&file.desc, &report, &error);
    hewn_progress_end();
    if (result != HEWN_OK)
        return hewn_report_misuse(command, &error);
    if (!file.quiet) {
        hewn_record_print(&report);
        own->print(&file.desc, &report);
        hewn_notes_print(&file.desc, &report);
    }
    hewn_file_report_destroy(&report);
    return 0;
}
