/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/experiment.h"

#include "core/text.h"
#include "experiment/experiment_source.h"
#include "muster/memory.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* The text is needed while the experiment is loaded, and no longer. */
static char experiment_text[EXPERIMENT_BYTES_MAX + 1];

/* libcyaml's first complaint, and the place that its backtrace names. */
struct experiment_complaint {
    char text[256];
    int line, column;
};

/* What stands before each piece of memory that libcyaml asks for, so that it can grow. */
union experiment_block {
    size_t bytes;
    max_align_t align;
};

/* Start-up memory for libcyaml: never freed, as all of ours.  (cyaml_mem_fn_t) */
static void *experiment_grow(void *ctx, void *old, size_t bytes)
{
    (void)ctx;
    if (bytes == 0) {
        return NULL;
    }
    union experiment_block *block = mu_startup_alloc(sizeof *block + bytes);
    block->bytes = bytes;
    if (old) {
        const union experiment_block *before = (union experiment_block *)old - 1;
        memcpy(block + 1, old, before->bytes < bytes ? before->bytes : bytes);
    }
    return block + 1;
}

/* libcyaml says "Load: Invalid FLOAT value: abc\n", then "Load: Backtrace:\n", then
 * "  in mapping field 'duration' (line: 1, column: 11)\n", innermost first.  (cyaml_log_fn_t) */
static void experiment_note(cyaml_log_t level, void *ctx, const char *format, va_list args)
{
    struct experiment_complaint *complaint = ctx;
    char message[256];
    if (level != CYAML_LOG_ERROR) {
        return;
    }
    vsnprintf(message, sizeof message, format, args);
    message[strcspn(message, "\n")] = '\0';
    const char *place = strstr(message, "(line: ");
    if (place && complaint->line == 0) {
        if (sscanf(place, "(line: %d, column: %d)", &complaint->line, &complaint->column) != 2) {
            complaint->line = 0;
        }
    } else if (complaint->text[0] == '\0') {
        const char *text = strncmp(message, "Load: ", 6) == 0 ? message + 6 : message;
        mu_text_copy(complaint->text, sizeof complaint->text, text);
    }
}

static mu_result experiment_load_fields(struct experiment_source *source, size_t len)
{
    struct experiment_complaint complaint = {.line = 0};
    cyaml_config_t config = {.log_fn = experiment_note,
                             .log_ctx = &complaint,
                             .mem_fn = experiment_grow,
                             .log_level = CYAML_LOG_ERROR,
                             .flags = CYAML_CFG_DEFAULT};
    cyaml_data_t *data = NULL;
    cyaml_err_t err = cyaml_load_data((const uint8_t *)experiment_text, len, &config,
                                      &experiment_schema, &data, NULL);
    source->experiment = data;
    if (err == CYAML_OK && data) {
        return MU_OK;
    }
    return mu_fault_at(source->fault, source->path, complaint.line, complaint.column, "%s",
                       complaint.text[0] ? complaint.text : cyaml_strerror(err));
}

static mu_result experiment_read(const char *path, size_t *len, struct mu_fault *fault)
{
    FILE *file = fopen(path, "re");
    if (!file) {
        return mu_fault_at(fault, path, 0, 0, "cannot read the experiment: %s", strerror(errno));
    }
    *len = fread(experiment_text, 1, sizeof experiment_text, file);
    mu_result result = MU_OK;
    if (ferror(file)) {
        result = mu_fault_at(fault, path, 0, 0, "cannot read the experiment: %s", strerror(errno));
    } else if (*len > EXPERIMENT_BYTES_MAX) {
        result = mu_fault_at(fault, path, 0, 0, "expected an experiment of at most %d bytes",
                             EXPERIMENT_BYTES_MAX);
    }
    fclose(file);
    return result;
}

static mu_result experiment_take_folder(struct experiment_source *source)
{
    struct experiment *e = source->experiment;
    const char *slash = strrchr(source->path, '/');
    struct mu_text folder;
    mu_text_init(&folder, e->folder, sizeof e->folder);
    if (slash) {
        size_t len = slash == source->path ? 1 : (size_t)(slash - source->path);
        mu_text_add_bytes(&folder, source->path, len);
    } else {
        mu_text_add(&folder, ".");
    }
    return folder.cut
               ? mu_fault_at(source->fault, source->path, 0, 0,
                             "expected a folder's path of at most %zu bytes", sizeof e->folder - 1)
               : MU_OK;
}

static mu_result experiment_load_tree(struct experiment_source *source, size_t len,
                                      const char *const *set, size_t set_count)
{
    mu_result result =
        yaml_check(source->tree, yaml_tree_root(source->tree), &experiment_schema, source->fault);
    if (result == MU_OK) {
        result = experiment_load_fields(source, len);
    }
    if (result == MU_OK) {
        result = experiment_take_folder(source);
    }
    if (result == MU_OK) {
        result = experiment_fill(source);
    }
    for (size_t i = 0; i < set_count && result == MU_OK; i++) {
        result = experiment_override(source, set[i]);
    }
    return result == MU_OK ? experiment_check(source) : result;
}

mu_result experiment_load(struct experiment **out, const char *path, const char *const *set,
                          size_t set_count, struct mu_fault *fault)
{
    struct experiment_source *source = mu_startup_alloc(sizeof *source);
    size_t len = 0;
    *out = NULL;
    source->path = mu_startup_string(path);
    source->fault = fault;
    mu_result result = experiment_read(source->path, &len, fault);
    if (result == MU_OK) {
        result = yaml_tree_open(&source->tree, source->path, experiment_text, len, fault);
    }
    if (result != MU_OK) {
        return result;
    }
    result = experiment_load_tree(source, len, set, set_count);
    yaml_tree_close(source->tree);
    if (result == MU_OK) {
        *out = source->experiment;
    }
    return result;
}
