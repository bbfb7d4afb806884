/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"
#include "core/name.h"

#include <inttypes.h>
#include <stdio.h>

_Static_assert((int)PARTS_END == (int)REGISTRY_OWN, "each part has its line in the white pages");

static const struct {
    const char *name, *job;
} parts[PARTS_END] = {
    [0] = {"broker", "all of them"},
    [PART_NAMES] = {"names", "which process has them, and in which state"},
    [PART_MAIL] = {"mail", "its way into boxes, and what becomes of it"},
    [PART_DELIVERY] = {"delivery", "what is ready for a process, as one sample"},
    [PART_GROUPS] = {"groups", "which agents are members of which group"},
    [PART_SERVICES] = {"services", "the yellow pages"},
    [PART_TRUST] = {"trust", "whose directives are carried out"},
    [PART_JOURNAL] = {"journal", "what must be on disk before any process is told"},
    [PART_FEDERATION] = {"federation", "the other brokers"},
};

static uint64_t refused(const struct broker *b)
{
    return b->counters.refused + b->unspoken;
}

#define AT(member) \
    .offset = offsetof(struct broker, member), .size = sizeof((struct broker *)0)->member

/* Mails are counted per receiver. */
static const struct metric counters[] = {
    {PART_NAMES, "agents", "agents that are there now", AT(registry.present)},
    {PART_NAMES, "names", "names that it knows now, the broker and its parts included",
     AT(registry.live)},
    {PART_NAMES, "names-ended", "names that were absent, held nothing, and made room",
     AT(retirement.ended)},
    {PART_NAMES, "processes", "processes that it serves now", AT(processes.names.count)},
    {PART_NAMES, "claims", "names that another process waits for now", AT(claims.pool.live)},
    {PART_NAMES, "snapshots", "snapshots of agents on their way that it keeps now",
     AT(snapshots.count), .was = "capsules"},
    {PART_NAMES, "snapshots-kept", "of them, ever", AT(snapshots.kept), .was = "capsules-kept"},
    {PART_NAMES, "snapshots-refused", "of them, whose agents stayed", AT(snapshots.refused),
     .was = "capsules-refused"},
    {PART_NAMES, "snapshots-restored", "of them, given to a host because no process had the agent",
     AT(snapshots.restored), .was = "capsules-restored"},
    {PART_NAMES, "changes", "changes of the white pages", AT(registry.changes.version)},
    {PART_NAMES, "by-socket",
     "readers of its deliveries, two a process, that have them by a socket", AT(ways.sockets)},
    {PART_NAMES, "by-dds", "of these readers, those that have them by DDS", AT(ways.dds)},
    {PART_NAMES, "sockets-refused", "connections that did not come about, ever", AT(ways.refused)},

    {PART_MAIL, "sent", "mails, one a receiver", AT(counters.sent)},
    {PART_MAIL, "delivered", "of them, acknowledged", AT(counters.delivered)},
    {PART_MAIL, "waiting", "of them, in a box now", AT(mailbox.posts_pool.live)},
    {PART_MAIL, "expired", "of them, older than they might become", AT(counters.expired)},
    {PART_MAIL, "dropped", "of them, taken out of a full box for others", AT(counters.dropped)},
    {PART_MAIL, "box-full", "of them, refused for want of room", AT(counters.box_full)},
    {PART_MAIL, "over-share", "of them, refused for their sender's share", AT(counters.over_share)},
    {PART_MAIL, "unknown-name", "of them, to a name that no agent ever had",
     AT(counters.unknown_name)},
    {PART_MAIL, "refused", "of them, directives that the policy does not allow",
     AT(counters.refused)},
    {PART_MAIL, "no-store", "of them, refused for want of a disk that can be written to",
     AT(counters.no_store)},
    {PART_MAIL, "resolving", "mails that wait for an address to be resolved, now",
     AT(resolve.pool.live)},
    {PART_MAIL, "resolve-asked", "addresses that a resolver was asked about", AT(resolve.asked)},
    {PART_MAIL, "resolve-refused", "answers of resolvers that were not asked, or too late",
     AT(resolve.refused)},
    {PART_MAIL, "duplicates-dropped", "mails that came twice from their sender",
     AT(counters.duplicates_dropped)},
    {PART_MAIL, "receipts-lost", "words on mails that were not told, for want of room",
     AT(receipts.lost)},
    {PART_MAIL, "gaps", "mails not taken yet, for an earlier one of their sender or box is missing",
     AT(gaps)},
    {PART_MAIL, "acks-astray",
     "acknowledgements that were for an earlier life of the broker, and not counted", AT(astray)},
    {PART_MAIL, "malformed", "samples and mails that break a rule of the wire",
     AT(counters.malformed)},
    {PART_MAIL, "stored", "mails kept now, each once", AT(pool.mails)},
    {PART_MAIL, "oldest-ns", "age of the oldest mail that waits, in nanoseconds", .drifts = true,
     .read = outcome_oldest_ns},

    {PART_DELIVERY, "deliveries", "samples written to processes", AT(dispatch.count.deliveries)},
    {PART_DELIVERY, "multicasts", "of them, those written once for many processes",
     AT(dispatch.count.multicasts), .was = "circulars"},
    {PART_DELIVERY, "items", "mails in them", AT(dispatch.count.items), .was = "parcels"},
    {PART_DELIVERY, "most-items", "mails in the fullest of them", AT(dispatch.count.most_items),
     .was = "most-parcels"},
    {PART_DELIVERY, "resent", "mails handed out again, for want of an acknowledgement",
     AT(counters.resent)},
    {PART_DELIVERY, "blocked", "times that the network did not take a delivery",
     AT(dispatch.count.blocked)},
    {PART_DELIVERY, "interval-ns", "the delivery interval, in nanoseconds; 0: at once",
     AT(dispatch.interval_ns)},
    {PART_DELIVERY, "wakings", "times that it woke to deliver, at an interval",
     AT(dispatch.count.wakings)},
    {PART_DELIVERY, "delay-ns", "what the interval has added to all mails together, in nanoseconds",
     AT(dispatch.count.delay_ns)},

    {PART_GROUPS, "groups", "groups that are there now", AT(pages.groups.keys_now)},
    {PART_GROUPS, "members", "memberships that hold now", AT(pages.groups.now)},
    {PART_GROUPS, "lines", "lines of the table in use now, those that hold no longer included",
     AT(pages.groups.pairs.count)},
    {PART_GROUPS, "changes", "changes of groups", AT(pages.groups.changes.version)},

    {PART_SERVICES, "offers", "services offered now, those of absent agents included",
     AT(pages.services.now)},
    {PART_SERVICES, "subscriptions", "standing queries now", AT(pages.subscriptions.count)},
    {PART_SERVICES, "lines", "lines of the table in use now, those withdrawn included",
     AT(pages.services.pairs.count)},
    {PART_SERVICES, "changes", "changes of services", AT(pages.services.changes.version)},

    {PART_TRUST, "lines", "lines of the policy", AT(trust.lines_count)},
    {PART_TRUST, "allowed",
     "directives let through, one a receiver, and changes in another agent's name", AT(directed)},
    {PART_TRUST, "refused", "of both, refused", .read = refused},
    {PART_TRUST, "probes", "lines that only look, let through outside of every step",
     AT(probes.asked), .was = "glances"},
    {PART_TRUST, "probes-declined", "lines that only look, and came back without an answer",
     AT(probes.declined), .was = "glances-declined"},
    {PART_TRUST, "probes-lost", "of them, those that were not told, because too many waited",
     AT(probes.lost), .was = "glances-lost"},
    {PART_TRUST, "audited", "records for the audit log", AT(audit.recorded)},
    {PART_TRUST, "audit-lost", "records lost, because too many waited", AT(audit.lost)},
    {PART_TRUST, "audit-failed", "records that could not be written", AT(audit.failed)},

    {PART_JOURNAL, "commits", "transactions that are on disk", AT(journal.commits)},
    {PART_JOURNAL, "failures", "transactions that failed", AT(journal.failures)},

    {PART_FEDERATION, "peers", "other brokers that are there now", AT(federation.peers_there)},
    {PART_FEDERATION, "announced", "parts of the white pages told to them",
     AT(federation.count.announced)},
    {PART_FEDERATION, "items-in", "mails taken from them", AT(federation.count.items_in),
     .was = "parcels-in"},
    {PART_FEDERATION, "repeated", "mails that came from them once more",
     AT(federation.count.repeated)},
    {PART_FEDERATION, "passed-on", "of the mails sent, those that they have taken over",
     AT(federation.count.passed_on)},
    {PART_FEDERATION, "receipts-in", "receipts that came from them",
     AT(federation.count.receipts_in)},
    {PART_FEDERATION, "clashes", "agents that had to give their name to one that had it before",
     AT(federation.count.clashes)},
    {PART_FEDERATION, "hops-refused", "mails that had passed too many brokers",
     AT(federation.count.hops_refused)},
    {PART_FEDERATION, "earlier-lives", "words from an earlier life of one of them, not taken",
     AT(federation.count.earlier_lives)},
};

enum { COUNTERS = sizeof counters / sizeof counters[0] };

_Static_assert((int)COUNTERS <= (int)METRICS_MAX, "every counter has its place");

const char *metrics_part_name(uint32_t part)
{
    return part < PARTS_END ? parts[part].name : NULL;
}

const struct metric *metrics_at(size_t index)
{
    return index < COUNTERS ? &counters[index] : NULL;
}

uint64_t metrics_value(const struct broker *b, const struct metric *c)
{
    if (c->read) {
        return c->read(b);
    }
    uint32_t small = 0;
    uint64_t large = 0;
    const char *at = (const char *)b + c->offset;
    memcpy(c->size == sizeof small ? (void *)&small : (void *)&large, at, c->size);
    return large + small;
}

void metrics_print(void)
{
    enum metrics_part part = 0;
    for (size_t i = 0; i < COUNTERS; i++) {
        const struct metric *c = &counters[i];
        if (c->part != part) {
            part = c->part;
            char name[MU_NAME_MAX + 1];
            snprintf(name, sizeof name, "broker.%s", parts[part].name);
            printf("\n## %s: %s\n", name, parts[part].job);
            if (mu_name_was(name)) {
                printf("\nFor one version it answers to `%s`, too.\n", mu_name_was(name));
            }
            printf("\n| Counter | What it counts | In 0.1 |\n| --- | --- | --- |\n");
        }
        printf("| `%s` | %s | %s |\n", c->name, c->counts, c->was ? c->was : "");
    }
}

/* By the names of now, or those with another one by that of the version before.  The broker itself
 * says with each whose it is. */
static void counters_add(const struct broker *b, struct mu_text *t, uint32_t own, bool before)
{
    const struct metric *c;
    for (size_t i = 0; (c = metrics_at(i)); i++) {
        const char *part = b->registry.agents[c->part].name;
        const char *was = own == REGISTRY_BROKER ? mu_name_was(part) : NULL;
        if ((own != REGISTRY_BROKER && own != c->part) || (before && !was && !c->was)) {
            continue;
        }
        if (own == REGISTRY_BROKER) {
            mu_text_format(t, " %s.", (before && was ? was : part) + strlen("broker."));
        }
        mu_text_format(t, "%s%s %" PRIu64, own == REGISTRY_BROKER ? "" : " ",
                       before && c->was ? c->was : c->name, metrics_value(b, c));
    }
}

void metrics_answer(struct broker *b, uint32_t own, const struct mail *question)
{
    const char *refusal = scope_refuses_counters(b->registry.agents[question->sender].scope);
    if (refusal) {
        (void)answer_begin(b, refusal);
        answer_reply(b, own, question, "failure");
        return;
    }
    struct mu_text t = answer_begin(b, metrics_part_name(own));
    counters_add(b, &t, own, false);
    counters_add(b, &t, own, true);
    MU_ASSERT(!t.cut);
    answer_reply(b, own, question, "inform");
}
