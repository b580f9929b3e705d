#include "pipeline/stages.h"

#include <stdio.h>

#include "base/clock.h"

hewn_stages hewn_stages_start(double began, hewn_report_stage *list, uint32_t room, uint32_t *count)
{
    double now = hewn_clock_now();
    return (hewn_stages){.began = began > 0 ? began : now, .stage = now, .list = list, .count = count, .room = room};
}

void hewn_stage_begin(hewn_stages *stages)
{
    stages->stage = hewn_clock_now();
}

void hewn_stage_end(hewn_stages *stages, const char *name)
{
    if (*stages->count == stages->room)
        return;
    hewn_report_stage *stage = &stages->list[(*stages->count)++];
    snprintf(stage->name, sizeof stage->name, "%s", name);
    stage->begin = stages->stage - stages->began;
    stage->end = hewn_stages_seconds(stages);
}

double hewn_stages_seconds(const hewn_stages *stages)
{
    return hewn_clock_now() - stages->began;
}
