/* Questions on the host: all threads take from one list, a block at a time. */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/clock.h"
#include "base/progress.h"
#include "query/internal.h"

/* Seconds that a block should take, so that whoever wants to stop is heard soon. */
#define SHORT 0.05

enum { FEW = 16, MANY = 4096 };

size_t hewn_query_next_block(size_t size, size_t least, size_t most, double seconds)
{
    if (seconds < SHORT)
        return 2 * size <= most ? 2 * size : most;
    return seconds > 4 * SHORT && size / 2 >= least ? size / 2 : size;
}

static void find_normal(hewn_asker *asker, hewn_answer *answer)
{
    float p[3], g[3];
    for (int axis = 0; axis < 3; axis++)
        p[axis] = (float)answer->point[axis];
    hewn_ask_gradient(asker, p, g);
    double length = sqrt((double)g[0] * (double)g[0] + (double)g[1] * (double)g[1] + (double)g[2] * (double)g[2]);
    for (int axis = 0; axis < 3; axis++)
        answer->normal[axis] = length > 0 && isfinite(length) ? (double)g[axis] / length : 0;
}

static bool lacks_normal(const hewn_question *question, const hewn_answer *answer)
{
    bool ball = question->kind == HEWN_QUERY_BALL, ray = question->kind == HEWN_QUERY_RAY;
    return answer->found && (ray || (ball && answer->inside));
}

hewn_result hewn_query_ask_host(const hewn_query *query, const hewn_question *questions, const uint32_t *which,
                                size_t count, const hewn_query_limits *limits, hewn_answer *answers, hewn_error *error)
{
    hewn_result all = HEWN_OK;
    hewn_error reason = {0};
#pragma omp parallel if (count > 1)
    {
        hewn_asker asker;
        hewn_error own = {0};
        hewn_result result = hewn_asker_create(query, &asker, &own);
#pragma omp for schedule(dynamic, 4)
        for (size_t i = 0; i < count; i++) {
            size_t at = which ? which[i] : i;
            if (result == HEWN_OK && which && answers[at].complete)
                find_normal(&asker, &answers[at]);
            else if (result == HEWN_OK)
                result = hewn_query_search(&asker, &questions[at], limits, &answers[at], &own);
        }
#pragma omp critical(hewn_query)
        if (result != HEWN_OK && all == HEWN_OK) {
            all = result;
            reason = own;
        }
        hewn_asker_destroy(&asker);
    }
    if (all != HEWN_OK && error)
        *error = reason;
    return all;
}

/* What takes long comes first, so that blocks are small there. */
static size_t gather(const hewn_question *questions, size_t count, const hewn_answer *answers, uint32_t *left)
{
    size_t found = 0;
    for (int complete = 0; complete < 2; complete++)
        for (size_t i = 0; i < count; i++)
            if (answers[i].complete == complete && (!complete || lacks_normal(&questions[i], &answers[i])))
                left[found++] = (uint32_t)i;
    return found;
}

hewn_result hewn_query_finish(const hewn_query *query, const hewn_question *questions, size_t count,
                              const hewn_query_limits *limits, const hewn_query_part *part, hewn_answer *answers,
                              hewn_error *error)
{
    uint32_t *left = hewn_alloc(count, sizeof *left);
    if (!left)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for questions");
    size_t all = gather(questions, count, answers, left);
    hewn_result result = HEWN_OK;
    for (size_t first = 0, size = FEW, taken; first < all && result == HEWN_OK; first += taken) {
        double began = hewn_clock_now(), done = part->begin + part->share * (double)first / (double)all;
        taken = all - first < size ? all - first : size;
        result = hewn_progress_report(part->progress, "query", done, error);
        if (result == HEWN_OK)
            result = hewn_query_ask_host(query, questions, left + first, taken, limits, answers, error);
        size = hewn_query_next_block(size, FEW, MANY, hewn_clock_now() - began);
    }
    hewn_free(left);
    return result;
}
