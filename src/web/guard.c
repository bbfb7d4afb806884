/* SPDX-License-Identifier: Apache-2.0 */
#include "web/web.h"

#include <stdio.h>
#include <string.h>

static const struct {
    unsigned status;
    const char *text;
} verdicts[GUARD_VERDICTS] = {
    [GUARD_PASSED] = {200, ""},
    [GUARD_HOST] = {403, "refused: this page is called 127.0.0.1 or localhost\n"},
    [GUARD_ORIGIN] = {403, "refused: another site asks\n"},
    [GUARD_METHOD] = {405, "refused: not this method\n"},
    [GUARD_PATH] = {404, "there is no such page\n"},
    [GUARD_TOKEN] = {403, "refused: to act, open the address that muster web has printed\n"},
    [GUARD_READ_ONLY] = {403, "refused: this page was started with --read-only\n"},
    [GUARD_SIZE] = {413, "refused: a line has at most 16384 bytes\n"},
};

void guard_init(struct guard *g, const uint8_t random[GUARD_TOKEN_DIGITS / 2], bool read_only)
{
    *g = (struct guard){.read_only = read_only};
    for (size_t i = 0; i < GUARD_TOKEN_DIGITS / 2; i++) {
        snprintf(g->token + 2 * i, 3, "%02x", random[i]);
    }
}

/* A tunnel may lead to us from another port, so the port is not looked at; the name is what a
 * foreign site cannot have. */
static bool host_is_ours(const char *host)
{
    static const char *const names[] = {"127.0.0.1", "localhost"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        size_t len = strlen(names[i]);
        const char *port = host + len + 1;
        if (strncmp(host, names[i], len) != 0) {
            continue;
        }
        if (host[len] == '\0') {
            return true;
        }
        return host[len] == ':' && *port && strlen(port) <= 5 &&
               strspn(port, "0123456789") == strlen(port);
    }
    return false;
}

/* Origin is "http://" and the very host that was asked. */
static bool origin_is_ours(const char *origin, const char *host)
{
    static const char scheme[] = "http://";
    return strncmp(origin, scheme, sizeof scheme - 1) == 0 &&
           strcmp(origin + sizeof scheme - 1, host) == 0;
}

static bool site_is_ours(const struct guard_request *r)
{
    return !r->site || strcmp(r->site, "same-origin") == 0 || strcmp(r->site, "none") == 0 ||
           (r->is_entry && r->use == GUARD_LOOK);
}

/* Takes the same time wherever the first wrong digit is. */
static bool token_is_good(const struct guard *g, const char *token)
{
    unsigned wrong = 0;
    if (!token || strlen(token) != GUARD_TOKEN_DIGITS) {
        return false;
    }
    for (size_t i = 0; i < GUARD_TOKEN_DIGITS; i++) {
        wrong |= (unsigned)(token[i] ^ g->token[i]);
    }
    return wrong == 0;
}

static bool method_fits(const struct guard_request *r)
{
    bool reads = strcmp(r->method, "GET") == 0 || strcmp(r->method, "HEAD") == 0;
    bool acts = strcmp(r->method, "POST") == 0;
    return r->use == GUARD_NOTHING ? reads || acts : r->use == GUARD_LOOK ? reads : acts;
}

static enum guard_verdict verdict_find(const struct guard *g, const struct guard_request *r)
{
    if (r->hosts != 1 || !r->host || !host_is_ours(r->host)) {
        return GUARD_HOST;
    }
    if ((r->origin && !origin_is_ours(r->origin, r->host)) || !site_is_ours(r)) {
        return GUARD_ORIGIN;
    }
    if (!method_fits(r)) {
        return GUARD_METHOD;
    }
    if (r->use == GUARD_NOTHING) {
        return GUARD_PATH;
    }
    if (r->use == GUARD_ACT && g->read_only) {
        return GUARD_READ_ONLY;
    }
    if (r->use == GUARD_ACT && !token_is_good(g, r->token)) {
        return GUARD_TOKEN;
    }
    return r->body_bytes > GUARD_BODY_MAX ? GUARD_SIZE : GUARD_PASSED;
}

enum guard_verdict guard_judge(struct guard *g, const struct guard_request *r)
{
    enum guard_verdict verdict = verdict_find(g, r);
    g->refused[verdict] += verdict != GUARD_PASSED;
    return verdict;
}

unsigned guard_status(enum guard_verdict verdict)
{
    return verdicts[verdict].status;
}

const char *guard_text(enum guard_verdict verdict)
{
    return verdicts[verdict].text;
}
