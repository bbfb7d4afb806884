/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A kind and a child that overrides one of its handlers, in a layer of their own: kinds [DOMAIN]
 *
 * Both agents sell in layer 4.  The shop names its price and takes back nothing; the thrifty shop
 * is a shop, but knows what it paid: its price is lower, and it does not let itself be disposed of.
 */
#include <muster/muster.h>
#include <stdlib.h>

enum { LAYER_TRADE = 4 };

static enum mu_take answer(mu_agent *a, const struct mu_mail *mail, const char *content)
{
    return mu_agent_reply(a, mail, "propose", content) == MU_OK ? MU_TAKEN : MU_DECLINE;
}

static enum mu_take shop_price(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    return answer(a, mail, "price 10");
}

static enum mu_take shop_refuse(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    (void)a;
    (void)mail;
    return MU_DECLINE; /* the runtime answers `refuse` */
}

static const struct mu_layer_handler shop_handlers[] = {
    {LAYER_TRADE, "cfp", shop_price}, {LAYER_TRADE, "give-back", shop_refuse}, {0}};
static const struct mu_agent_kind shop = {.name = "shop", .handlers = shop_handlers};

static enum mu_take thrifty_price(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    bool in_bulk = mail->content[0] != '\0';
    return in_bulk ? answer(a, mail, "price 7") : mu_agent_take_parent(a, mail);
}

static const struct mu_layer_handler thrifty_handlers[] = {
    {LAYER_TRADE, "cfp", thrifty_price}, {MU_LAYER_SYSTEM, "dispose", shop_refuse}, {0}};
static const struct mu_agent_kind thrifty = {
    .name = "thrifty", .parent = &shop, .handlers = thrifty_handlers};

static mu_result enter(mu_process *p, const char *name, const struct mu_agent_kind *kind)
{
    mu_agent *a;
    mu_result joined =
        mu_agent_join(p, &a, name, MU_KIND_AGENT, 0, &(struct mu_handlers){.self = NULL});
    if (joined == MU_OK) {
        mu_agent_be(a, kind);
    }
    return joined;
}

int main(int argc, char **argv)
{
    const char *domain = argc > 1 ? argv[1] : getenv("MUSTER_DOMAIN");
    struct mu_process_options options = {.domain = domain ? (int)strtol(domain, NULL, 10) : 0};
    mu_process *process;
    if (mu_process_open(&process, &options) != MU_OK || enter(process, "shop", &shop) != MU_OK ||
        enter(process, "thrifty", &thrifty) != MU_OK) {
        return EXIT_FAILURE;
    }
    mu_result ran = mu_process_run(process);
    mu_process_close(process);
    return ran == MU_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
