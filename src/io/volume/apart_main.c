/* The program that reads volumes apart (io/volume/apart.h): it reads what its arguments name and writes the reply. */
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "io/volume/apart.h"
#include "io/volume/formats.h"
#include "volume/voxel.h"

/* A number that lies may ask for all memory there is; then it gets none. The sanitizers need all addresses. */
static void limit_memory(const hewn_volume_source *source)
{
#if !defined(__SANITIZE_ADDRESS__)
    static const uint64_t SPARE = (uint64_t)1 << 26; /* bytes for the library itself */
    unsigned long pages = 0;
    FILE *file = fopen("/proc/self/statm", "re");
    bool known =
        file && fscanf(file, "%*u %*u %*u %*u %*u %lu", &pages) == 1; /* data and stack, as RLIMIT_DATA counts */
    if (file)
        fclose(file);
    /* libraries copy a file, more than once */
    uint64_t most = 2 * hewn_volume_limit(source) + 4 * (uint64_t)source->length + SPARE +
                    (uint64_t)pages * (uint64_t)sysconf(_SC_PAGESIZE);
    const struct rlimit limit = {most, most};
    if (known)
        setrlimit(RLIMIT_DATA, &limit);
#else
    (void)source;
#endif
}

/* Nor may it work for ever. Of a folder nobody knows how much there is. */
static void limit_time(const hewn_volume_source *source)
{
    uint64_t seconds = 60 + source->length / (1 << 18);
    const struct rlimit limit = {seconds, seconds};
    if (source->bytes)
        setrlimit(RLIMIT_CPU, &limit);
}

/* Nobody wants a core of it, nor its work when who asked for it is gone. */
static void limit(const hewn_volume_source *source)
{
    const struct rlimit no_core = {0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    limit_memory(source);
    limit_time(source);
}

static bool map_input(int file, hewn_volume_source *source)
{
    struct stat status;
    if (fstat(file, &status) != 0)
        return false;
    source->length = (size_t)status.st_size;
    source->bytes = source->length > 0 ? mmap(NULL, source->length, PROT_READ, MAP_PRIVATE, file, 0) : "";
    return source->bytes != MAP_FAILED;
}

static void copy_text(char *out, size_t room, const char *text)
{
    snprintf(out, room, "%s", text ? text : "");
}

static uint64_t bytes_of(const hewn_volume *volume)
{
    if (volume->blocks)
        return volume->memory_length;
    return hewn_volume_frame_size(volume) * volume->frame_count * hewn_voxel_size(volume->type);
}

static hewn_apart_reply reply_of(const hewn_volume *volume)
{
    hewn_apart_reply reply = {.result = HEWN_OK, .volume = *volume, .blocks = volume->blocks != NULL};
    reply.sample_bytes = bytes_of(volume);
    copy_text(reply.name, sizeof reply.name, volume->name);
    copy_text(reply.remark, sizeof reply.remark, volume->remark);
    copy_text(reply.unit, sizeof reply.unit, volume->unit ? volume->unit->name : NULL);
    return reply;
}

/* Sends the reply, and the samples unless the reader wrote them into the file itself. */
static bool send_reply(const hewn_volume *volume, const hewn_apart_reply *reply, int file)
{
    char page[HEWN_VOLUME_ROOM_AT] = {0};
    memcpy(page, reply, sizeof *reply);
    if (reply->result == HEWN_OK && volume->mapped && (volume->blocks || volume->samples == volume->memory) &&
        volume->memory_length == reply->sample_bytes)
        return pwrite(file, page, sizeof page, 0) == (ssize_t)sizeof page;
    return ftruncate(file, 0) == 0 && hewn_file_put(file, page, sizeof page) &&
           (reply->sample_bytes == 0 ||
            hewn_file_put(file, volume->blocks ? volume->memory : volume->samples, reply->sample_bytes));
}

static hewn_result read_here(hewn_apart_reader reader, const char *name, hewn_volume_source *source, hewn_volume *out,
                             hewn_error *error)
{
    switch (reader) {
    case HEWN_APART_VDB: return hewn_vdb_read_here(source, out, error);
    case HEWN_APART_DICOM: return hewn_dicom_read_here(source, out, error);
    case HEWN_APART_DICOM_FOLDER: break;
    }
    return hewn_dicom_read_folder_here(name, source->desc, out, error);
}

int main(int count, char **arguments)
{
    if (count < HEWN_APART_CHOICE || strcmp(arguments[HEWN_APART_VERSION], hewn_version()) != 0) {
        fprintf(stderr, "%s: not for people: Hewn runs it to read .vdb and DICOM files\n", HEWN_APART_PROGRAM);
        return HEWN_APART_OTHER_VERSION;
    }
    const char *choice = count > HEWN_APART_CHOICE ? arguments[HEWN_APART_CHOICE] : NULL;
    const int reply_file = atoi(arguments[HEWN_APART_REPLY]), input = atoi(arguments[HEWN_APART_INPUT]) - 1;
    const hewn_volume_read_desc desc = {.grid = choice,
                                        .series = choice,
                                        .blocks = atoi(arguments[HEWN_APART_BLOCKS]) != 0,
                                        .memory_limit = strtoull(arguments[HEWN_APART_LIMIT], NULL, 10)};
    hewn_volume_source source = {
        .name = arguments[HEWN_APART_NAME], .desc = &desc, .room_file = input >= 0 ? reply_file : 0};
    hewn_volume volume = {0};
    hewn_error error = {0};
    if (input >= 0 && !map_input(input, &source))
        return HEWN_APART_NO_REPLY;
    limit(&source);
    hewn_result result = read_here((hewn_apart_reader)atoi(arguments[HEWN_APART_READER]), arguments[HEWN_APART_NAME],
                                   &source, &volume, &error);
    const hewn_apart_reply reply =
        result == HEWN_OK ? reply_of(&volume) : (hewn_apart_reply){.result = result, .error = error};
    _exit(send_reply(&volume, &reply, reply_file) ? 0
                                                  : HEWN_APART_NO_REPLY); /* libraries have nothing to tidy up here */
}
