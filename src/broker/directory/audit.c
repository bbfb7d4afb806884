/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/directory/directory.h"

#include "core/json.h"
#include "core/text.h"

#include <string.h>

struct audit_record *audit_add(struct audit *a)
{
    if (!a->on) {
        return NULL;
    }
    if (a->count == MU_AUDIT_MAX) {
        a->lost++;
        return NULL;
    }
    struct audit_record *r = &a->ring[(a->head + a->count++) % MU_AUDIT_MAX];
    *r = (struct audit_record){0};
    a->recorded++;
    return r;
}

void audit_receiver(struct audit_record *r, const char *name)
{
    if (!r) {
        return;
    }
    struct mu_text text = {
        .at = r->receiver, .len = strlen(r->receiver), .size = sizeof r->receiver};
    mu_text_add(&text, r->receivers++ ? "," : "");
    mu_text_add(&text, name);
}

bool audit_next(struct audit *a, struct audit_record *out)
{
    if (a->count == 0) {
        return false;
    }
    *out = a->ring[a->head];
    a->head = (a->head + 1) % MU_AUDIT_MAX;
    a->count--;
    return true;
}

/* Every byte of a text can become six in JSON. */
_Static_assert(6 * (2 * AUDIT_TEXT_MAX + MU_NAME_MAX + MU_PROCESS_MAX + MU_FIELD_MAX) + 256 <
                   AUDIT_LINE_MAX,
               "a record fits a line");

size_t audit_line(const struct audit_record *r, char line[AUDIT_LINE_MAX])
{
    struct mu_json j;
    struct mu_text text = mu_text_in(line, AUDIT_LINE_MAX);
    mu_json_to_text(&j, &text, MU_JSON_LINE);
    mu_json_object(&j, NULL);
    mu_json_string(&j, "clock", r->simulated ? "simulated" : "wall");
    mu_json_uint(&j, "time_ns", r->time_ns);
    mu_json_string(&j, "sender", r->sender);
    mu_json_string(&j, "process", r->process);
    mu_json_string(&j, "receiver", r->receiver);
    mu_json_uint(&j, "receivers", r->receivers);
    mu_json_string(&j, "performative", r->performative);
    mu_json_string(&j, "line", r->line);
    mu_json_bool(&j, "allowed", r->allowed);
    mu_json_end(&j);
    MU_ASSERT(!text.cut);
    return text.len;
}
