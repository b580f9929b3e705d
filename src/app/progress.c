#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/app.h"
#include "base/clock.h"

static volatile sig_atomic_t cancelled;
/* Reading a scene cannot be interrupted (it may wait for a pipe, or run the scene's own endless loop), but nothing
 * needs to be cleaned up then: the process may end right away. */
static volatile sig_atomic_t may_end_at_once;
/* The same all the time, but in the stage "write". */
static volatile sig_atomic_t writes_last;
/* A file that is not complete and has to go then; or "". Changed only while nothing may end at once. */
static char doomed[4096];

static const int caught[] = {SIGINT, SIGTERM, SIGHUP};
enum { CAUGHT = sizeof caught / sizeof *caught };

/* With what a handler of signals may call. */
static void end_at_once(void)
{
    static const char message[] = "hewn: cancelled\n";
    if (doomed[0])
        unlink(doomed);
    (void)!write(STDERR_FILENO, message, sizeof message - 1);
    _exit(hewn_exit_code(HEWN_CANCELLED));
}

static void on_signal(int number)
{
    (void)number;
    cancelled = 1;
    if (may_end_at_once)
        end_at_once();
    for (int i = 0; i < CAUGHT; ++i)
        signal(caught[i], SIG_DFL);
}

void hewn_signals_catch(void)
{
    struct sigaction action = {.sa_handler = on_signal, .sa_flags = SA_RESTART}, old;
    sigemptyset(&action.sa_mask);
    for (int i = 0; i < CAUGHT; ++i)
        sigaddset(&action.sa_mask, caught[i]);
    for (int i = 0; i < CAUGHT; ++i)
        if (sigaction(caught[i], NULL, &old) == 0 && old.sa_handler != SIG_IGN) /* as under nohup */
            sigaction(caught[i], &action, NULL);
}

void hewn_signals_end_at_once(bool may, const char *remove)
{
    may_end_at_once = 0; /* while the name changes */
    bool fits = !remove || strlen(remove) < sizeof doomed;
    snprintf(doomed, sizeof doomed, "%s", remove && fits ? remove : "");
    writes_last = may && fits;
    may_end_at_once = writes_last;
    if (cancelled && may_end_at_once) /* before it was allowed */
        end_at_once();
}

bool hewn_signals_cancelled(void)
{
    return cancelled != 0;
}

/* The line on the terminal. There is one terminal, so there is one of these. */
static struct {
    bool wanted;
    bool shown;
    double drawn; /* when */
    char stage[32];
} line;

static bool report(void *user, const char *stage, double fraction)
{
    (void)user;
    may_end_at_once = writes_last ? strcmp(stage, "write") != 0 : strcmp(stage, "load") == 0;
    if (cancelled)
        return false;
    double now = hewn_clock_now();
    bool entered = strcmp(line.stage, stage) != 0;
    if (!line.wanted || (!entered && now - line.drawn < 0.05))
        return true;
    snprintf(line.stage, sizeof line.stage, "%s", stage);
    line.drawn = now;
    line.shown = true;
    fprintf(stderr, "\r\033[K%s %3.0f %%", stage, 100 * fraction);
    fflush(stderr);
    return true;
}

hewn_progress hewn_progress_begin(bool quiet)
{
    const char *terminal = getenv("TERM");
    line.wanted = !quiet && isatty(STDERR_FILENO) && !(terminal && strcmp(terminal, "dumb") == 0);
    line.stage[0] = '\0';
    return (hewn_progress){.report = report};
}

void hewn_progress_end(void)
{
    may_end_at_once = writes_last;
    if (line.shown)
        fprintf(stderr, "\r\033[K");
    line.shown = false;
}
