/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/resolver.h"

#include "core/fields.h"
#include "core/name.h"
#include "core/text.h"
#include "muster/directory.h"
#include "runtime/process.h"

#include <stdio.h>
#include <string.h>

struct mu_resolution {
    struct mu_text names; /* fields */
};

static mu_result scheme_advertise(mu_agent *a)
{
    char attributes[MU_NAME_MAX + 16];
    snprintf(attributes, sizeof attributes, "scheme=%s", a->resolver.scheme);
    return mu_agent_advertise(a, "resolver", attributes, 0);
}

mu_result mu_agent_resolve(mu_agent *a, const char *scheme, mu_resolve resolve, void *self)
{
    if (!scheme || !mu_name_valid(scheme) || !resolve) {
        return MU_MALFORMED;
    }
    a->resolver = (struct resolver){.resolve = resolve, .self = self};
    mu_text_copy(a->resolver.scheme, sizeof a->resolver.scheme, scheme);
    return a->name_state == NAME_ACCEPTED ? scheme_advertise(a)
                                          : MU_OK; /* else the broker is told in its time */
}

void resolver_offer(mu_agent *a)
{
    a->resolver.due = a->resolver.resolve && scheme_advertise(a) != MU_OK;
}

void resolver_retry(mu_agent *a)
{
    if (a->resolver.due && a->state != MU_GONE) {
        resolver_offer(a);
    }
}

mu_result mu_resolution_add(mu_resolution *r, const char *name)
{
    if (!name || !mu_name_valid(name)) {
        return MU_MALFORMED;
    }
    if (r->names.len + 1 + strlen(name) > MU_CONTENT_MAX) {
        return MU_FULL;
    }
    mu_text_format(&r->names, "%s%s", r->names.len ? " " : "", name);
    return MU_OK;
}

/* A question: resolve "SCHEME:REST" SENDER */
struct question {
    char address[MU_DST_MAX + 1];
    const char *sender; /* in the mail */
};

/* @return false: it is none of the broker's */
static bool question_read(const char *content, struct question *q)
{
    static const char begin[] = "resolve ";
    if (strncmp(content, begin, sizeof begin - 1) != 0) {
        return false;
    }
    struct mu_text t;
    const char *c = content + sizeof begin - 1;
    mu_text_init(&t, q->address, sizeof q->address);
    bool whole = *c == '"' && mu_fields_next(&c, &t) && *c == ' ';
    q->sender = whole ? c + 1 : "";
    return whole && mu_name_valid(q->sender);
}

enum mu_take resolver_take(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    static char names[MU_CONTENT_MAX + 1];
    static struct question q;
    struct mu_resolution r;
    const struct resolver *resolver = &a->resolver;
    size_t scheme = strlen(resolver->scheme);
    if (!resolver->resolve || strcmp(mail->src, "broker") != 0) {
        return MU_PASS;
    }
    mu_text_init(&r.names, names, sizeof names);
    bool good = question_read(mail->content, &q) &&
                strncmp(q.address, resolver->scheme, scheme) == 0 && q.address[scheme] == ':' &&
                resolver->resolve(resolver->self, a, q.address + scheme + 1, q.sender, &r);
    mu_result sent =
        mu_agent_reply(a, mail, good ? "inform" : "failure", good ? names : "no-such-address");
    (void)sent; /* a full outbox: the broker's patience is the answer */
    return MU_TAKEN;
}
