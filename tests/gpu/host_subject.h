/* A field that is extracted by the host or by the device's kernels. */
#ifndef HEWN_TEST_HOST_SUBJECT_H
#define HEWN_TEST_HOST_SUBJECT_H

#include "gpu_test.h"
#include "iso/extractor.h"
#include "random_fields.h"

typedef struct subject {
    hewn_field *field;
    hewn_extractor *extractor;
} subject;

static inline subject make_subject(hewn_device *on, maker *make, uint32_t seed, hewn_evaluation evaluation)
{
    subject made;
    GPU_TEST_TRY(hewn_field_create(&made.field, &error));
    hewn_node root = make(made.field, seed);
    const hewn_code_desc desc = {.evaluation = evaluation};
    GPU_TEST_TRY(hewn_extractor_create_as(on, made.field, root, &desc, &made.extractor, &error));
    assert_true(made.extractor->on_host); /* these tests run on CPU devices */
    return made;
}

static inline void free_subject(subject *made)
{
    hewn_extractor_destroy(&made->extractor);
    hewn_field_destroy(&made->field);
}

static inline hewn_triangles extract_with(const subject *made, bool on_host, const hewn_extract_desc *desc,
                                          hewn_extract_stats *stats)
{
    hewn_triangles mesh;
    made->extractor->on_host = on_host;
    GPU_TEST_TRY(hewn_extract(made->extractor, desc, &mesh, stats, &error));
    made->extractor->on_host = true;
    return mesh;
}

#endif
