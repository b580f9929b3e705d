#include "run.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

double run_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void run_sleep(double seconds)
{
    struct timespec pause = {.tv_sec = (time_t)seconds, .tv_nsec = (long)(1e9 * (seconds - (double)(time_t)seconds))};
    nanosleep(&pause, NULL);
}

/* --- starting ---------------------------------------------------------------------------------------------------- */

/* A file that has no name, to catch what is written. */
static int anonymous_file(void)
{
    char name[] = "/tmp/hewn-test-XXXXXX";
    int file = mkostemp(name, O_CLOEXEC);
    assert_true(file >= 0);
    unlink(name);
    return file;
}

static int open_terminal(int *controller)
{
    *controller = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (*controller < 0) {
        print_message("# no pseudo-terminals here (is /dev/pts mounted?)\n");
        skip();
    }
    assert_int_equal(grantpt(*controller), 0);
    assert_int_equal(unlockpt(*controller), 0);
    int terminal = open(ptsname(*controller), O_RDWR | O_NOCTTY | O_CLOEXEC);
    assert_true(terminal >= 0);
    return terminal;
}

static void change_environment(const run_desc *desc)
{
    for (int i = 0; i < RUN_MAX_CHANGES && desc->changes[i]; i++) {
        char *name = strdup(desc->changes[i]);
        char *equals = strchr(name, '=');
        if (equals) {
            *equals = '\0';
            setenv(name, equals + 1, 1);
        } else {
            unsetenv(name);
        }
        free(name);
    }
}

/* In the child: becomes the command. Signals are as a shell leaves them, whatever the test runner did. */
static void become_command(const run_desc *desc, int in, int out, int err)
{
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXFSZ};
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
        signal(signals[i], SIG_DFL);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
    dup2(in, STDIN_FILENO);
    dup2(out, STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
    change_environment(desc);
    if (desc->folder && chdir(desc->folder) != 0)
        _exit(126);
    if (desc->file_limit) {
        struct rlimit limit = {desc->file_limit, desc->file_limit};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    const char *command = desc->program ? desc->program : getenv("HEWN_COMMAND");
    char *arguments[RUN_MAX_ARGUMENTS + 2] = {(char *)(intptr_t)command};
    for (int i = 0; i < RUN_MAX_ARGUMENTS && desc->arguments[i]; i++)
        arguments[i + 1] = (char *)(intptr_t)desc->arguments[i];
    execvp(command, arguments);
    _exit(127);
}

run_process run_start(const run_desc *desc)
{
    assert_non_null(getenv("HEWN_COMMAND"));
    run_process process = {.terminal = desc->terminal, .timeout = desc->timeout > 0 ? desc->timeout : 120};
    int in = open(desc->input ? desc->input : "/dev/null", O_RDONLY | O_CLOEXEC);
    assert_true(in >= 0);
    process.out = desc->output ? open(desc->output, O_WRONLY | O_CREAT | O_CLOEXEC, 0666) : anonymous_file();
    assert_true(process.out >= 0);
    int err = desc->terminal ? open_terminal(&process.err) : (process.err = anonymous_file());
    process.started = run_now();
    process.id = fork();
    assert_true(process.id >= 0);
    if (process.id == 0)
        become_command(desc, in, process.out, err);
    close(in);
    if (desc->terminal)
        close(err);
    if (desc->output) {
        close(process.out);
        process.out = -1;
    }
    return process;
}

/* --- following --------------------------------------------------------------------------------------------------- */

/* Reads what is on the terminal, waiting for at most a hundredth of a second. */
static void read_terminal(run_process *process)
{
    struct pollfd poll_desc = {.fd = process->err, .events = POLLIN};
    while (process->terminal && poll(&poll_desc, 1, 10) > 0) {
        char *grown = realloc(process->seen, process->seen_length + 4097);
        assert_non_null(grown);
        process->seen = grown;
        ssize_t got = read(process->err, grown + process->seen_length, 4096);
        if (got <= 0) /* the other end was closed: EIO */
            got = 0;
        process->seen_length += (size_t)got;
        grown[process->seen_length] = '\0';
        if (got == 0)
            break;
    }
}

static void fail_if_late(run_process *process)
{
    if (run_now() - process->started < process->timeout)
        return;
    kill(process->id, SIGKILL);
    waitpid(process->id, NULL, 0);
    fail_msg("the command still runs after %g seconds; terminal: %s", process->timeout,
             process->seen ? process->seen : "");
}

void run_await(run_process *process, const char *text)
{
    for (;;) {
        read_terminal(process);
        char *found = process->seen ? strstr(process->seen, text) : NULL;
        if (found) {
            found += strlen(text);
            process->seen_length -= (size_t)(found - process->seen);
            memmove(process->seen, found, process->seen_length + 1);
            return;
        }
        if (!run_is_alive(process))
            fail_msg("the command ended without writing '%s': %s", text, process->seen ? process->seen : "");
        fail_if_late(process);
    }
}

bool run_is_alive(run_process *process)
{
    siginfo_t info = {0};
    return waitid(P_PID, (id_t)process->id, &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == 0;
}

static char *read_to_end(int file, size_t *length)
{
    off_t size = lseek(file, 0, SEEK_END);
    assert_true(size >= 0);
    char *text = malloc((size_t)size + 1);
    assert_non_null(text);
    assert_int_equal(pread(file, text, (size_t)size, 0), size);
    text[size] = '\0';
    *length = (size_t)size;
    close(file);
    return text;
}

run_result run_finish(run_process *process)
{
    while (run_is_alive(process)) {
        if (process->terminal)
            read_terminal(process);
        else
            run_sleep(0.002);
        fail_if_late(process);
    }
    run_result result = {.code = -1, .seconds = run_now() - process->started};
    int status;
    assert_int_equal(waitpid(process->id, &status, 0), process->id);
    if (WIFEXITED(status))
        result.code = WEXITSTATUS(status);
    else
        result.signal = WTERMSIG(status);
    size_t length;
    if (process->terminal) {
        read_terminal(process);
        close(process->err);
        result.err = process->seen ? process->seen : strdup("");
    } else {
        result.err = read_to_end(process->err, &length);
    }
    result.out = process->out >= 0 ? read_to_end(process->out, &result.out_length) : strdup("");
    return result;
}

run_result run(const run_desc *desc)
{
    run_process process = run_start(desc);
    return run_finish(&process);
}

void run_result_destroy(run_result *result)
{
    free(result->out);
    free(result->err);
    *result = (run_result){0};
}

static int count_messages(const char *text)
{
    int count = 0;
    for (const char *at = text; at; at = strchr(at, '\n') ? strchr(at, '\n') + 1 : NULL)
        count += strncmp(at, "hewn", 4) == 0;
    return count;
}

run_result run_expecting(int code, const run_desc *desc)
{
    run_result result = run(desc);
    if (result.code != code)
        fail_msg("exit code %d (signal %d) instead of %d; stderr: %s", result.code, result.signal, code, result.err);
    if (code != 0)
        assert_int_equal(count_messages(result.err), 1);
    return result;
}

/* --- files ------------------------------------------------------------------------------------------------------- */

char *run_folder_create(void)
{
    const char *parent = getenv("TMPDIR");
    char name[512];
    snprintf(name, sizeof name, "%s/hewn-cli-XXXXXX", parent && *parent ? parent : "/tmp");
    assert_non_null(mkdtemp(name));
    return strdup(name);
}

/* Calls `each` for every entry but `.` and `..`, if there is one, and counts them. */
static int visit(const char *folder, void (*each)(const char *path))
{
    DIR *listing = opendir(folder);
    assert_non_null(listing);
    int count = 0;
    for (struct dirent *entry; (entry = readdir(listing)) != NULL;) {
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        count++;
        char path[1024];
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        if (each)
            each(path);
    }
    closedir(listing);
    return count;
}

static void erase(const char *path)
{
    struct stat status;
    if (lstat(path, &status) == 0 && S_ISDIR(status.st_mode)) {
        visit(path, erase);
        rmdir(path);
    } else {
        unlink(path);
    }
}

void run_folder_destroy(char *folder)
{
    erase(folder);
    free(folder);
}

int run_folder_count(const char *folder)
{
    return visit(folder, NULL);
}

const char *run_path(const char *folder, const char *name)
{
    static char paths[8][1024];
    static int next;
    char *path = paths[next++ % 8];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

void run_write_file(const char *path, const char *text)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

bool run_file_exists(const char *path)
{
    struct stat status;
    return lstat(path, &status) == 0;
}

char *run_read_file(const char *path, size_t *length)
{
    int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0)
        fail_msg("%s: %s", path, strerror(errno));
    size_t ignored;
    return read_to_end(file, length ? length : &ignored);
}

void run_subfolder(const char *folder, const char *name)
{
    if (mkdir(run_path(folder, name), 0777) != 0)
        assert_int_equal(errno, EEXIST);
}

void run_assert_same_file(const char *a, const char *b)
{
    size_t length_a, length_b;
    char *bytes_a = run_read_file(a, &length_a);
    char *bytes_b = run_read_file(b, &length_b);
    assert_true(length_a > 1000);
    if (length_a != length_b || memcmp(bytes_a, bytes_b, length_a) != 0)
        fail_msg("%s and %s differ", a, b);
    free(bytes_a);
    free(bytes_b);
}

void run_need_program(const char *program)
{
    char *folders = strdup(getenv("PATH") ? getenv("PATH") : ""), *rest = NULL;
    bool found = false;
    for (char *folder = strtok_r(folders, ":", &rest); folder; folder = strtok_r(NULL, ":", &rest))
        found = found || access(run_path(folder, program), X_OK) == 0;
    free(folders);
    if (!found) {
        print_message("# the program %s is not installed\n", program);
        skip();
    }
}

const char *run_project_file(const char *name)
{
    const char *source = getenv("HEWN_SOURCE");
    assert_non_null(source);
    return run_path(source, name);
}

const char *run_data_file(const char *name)
{
    const char *data = getenv("HEWN_DATA");
    const char *path = run_path(data && *data ? data : run_project_file("../shared/data"), name);
    if (!run_file_exists(path)) {
        print_message("# the test data %s is missing\n", path);
        skip();
    }
    return path;
}
