/* Results, errors, progress and the version: what every other header of Hewn leans on. */
#ifndef HEWN_BASE_H
#define HEWN_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define HEWN_API __attribute__((visibility("default")))
#define HEWN_PRINTF(format_index, first) __attribute__((format(printf, format_index, first)))
#else
#define HEWN_API
#define HEWN_PRINTF(format_index, first)
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* What became of a call. Everything but HEWN_OK is a failure, and `*out` is then NULL or zero. */
typedef enum hewn_result {
    HEWN_OK = 0,
    HEWN_INVALID_ARGUMENT,     /* the caller asked for something that makes no sense */
    HEWN_BAD_INPUT,            /* a file, scene or field that cannot be used; message says where */
    HEWN_IO,                   /* the operating system refused a read or a write */
    HEWN_NO_LOADER,            /* no Vulkan loader library on this machine */
    HEWN_NO_DEVICE,            /* a loader, but no device, or none of the name asked for */
    HEWN_MISSING_FEATURE,      /* the device lacks something that Hewn needs */
    HEWN_DEVICE_LOST,          /* the driver gave the device up in the middle of work */
    HEWN_OUT_OF_DEVICE_MEMORY, /* the device has no room left */
    HEWN_OUT_OF_MEMORY,        /* the host has no room left */
    HEWN_LIMIT,                /* the result cannot be held by a format, an index or an allocation */
    HEWN_CANCELLED,            /* the progress callback returned false */
    HEWN_INTERNAL              /* a fault of Hewn itself; please report it */
} hewn_result;

/* Why a call failed. Plain data without ownership: put one on the stack and pass its address, or pass
 * NULL where the reason does not matter. Untouched when the call succeeds. */
typedef struct hewn_error {
    hewn_result code;
    uint32_t line;     /* 1-based line in `file`, 0 where it has no meaning */
    char file[256];    /* the file that is at fault (its tail when longer), or empty */
    char message[768]; /* one sentence, UTF-8, no final newline; does not repeat file and line */
} hewn_error;

/* Called now and then from the thread that started the work, with the name of the stage and the share
 * of it that is done (0 to 1). Returning false cancels the work, which then returns HEWN_CANCELLED. */
typedef struct hewn_progress {
    bool (*report)(void *user, const char *stage, double fraction);
    void *user;
} hewn_progress;

/* The version of the library, "MAJOR.MINOR.PATCH". Static storage, safe from any thread. */
HEWN_API const char *hewn_version(void);

/* A short English name of a result, for logs. Static storage, safe from any thread. */
HEWN_API const char *hewn_result_name(hewn_result result);

#ifdef __cplusplus
}
#endif
#endif
