/* SPDX-License-Identifier: Apache-2.0 */
#include "operator/operator.h"

#include "core/text_file.h"

#include <string.h>

/* A passport and the rules behind it. */
static char launch_bytes[LAUNCH_RULES_MAX + LAUNCH_HEAD_MAX];

struct mu_text *launch_text_begin(const char *name, bool start, int64_t seed)
{
    static struct mu_text text;
    mu_text_init(&text, launch_bytes, sizeof launch_bytes);
    mu_text_format(&text, "passport 3 robot launch %s %s 0 0 0 0 0 %lld 0 - \n", name,
                   start ? "running" : "standby", (long long)seed);
    return &text;
}

mu_result launch_text_rules(struct mu_text *out, const char *file)
{
    struct mu_fault fault;
    struct mu_text text = mu_text_in(out->at + out->len, out->size - out->len);
    mu_result read = mu_text_file_read(file, &text, &fault);
    if (read == MU_OK && (text.cut || strlen(text.at) != text.len || !words_are_utf8(text.at))) {
        read = mu_fault_at(&fault, file, 0, 0, "expected a text of at most 512 KiB, in UTF-8");
    }
    if (read != MU_OK) {
        mu_fault_print(&fault);
        return MU_FAULT_FILE;
    }
    out->len += text.len;
    return MU_OK;
}
