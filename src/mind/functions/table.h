/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file table.h
 * The one table of functions that rules may call.
 *
 * X(name, code, function, arguments, usage, text): code is the CLIPS return type ('u' any,
 * 'm' multifield), arguments a CLIPS restriction string: least, most (or *), then types (n number,
 * i whole number, k symbol or string, u any).
 */
#ifndef MUSTER_MIND_TABLE_H
#define MUSTER_MIND_TABLE_H

#include "mind/functions/functions.h"

/* clang-format off */
#define FUNCTIONS_PHYSICAL(X) \
    X("position", 'm', sensors_position, "00", \
      "(position)", \
      "the position fact's seven fields: time in s, x and y in mm, speed in mm/s, turn " \
      "rate in deg/s, compass in deg, stalled; `()` before the first percept") \
    X("gps", 'm', sensors_gps, "00", \
      "(gps)", \
      "x and y in mm, compass in deg, as GPS and compass say; `()` before the first percept") \
    X("odometer", 'm', sensors_odometer, "00", \
      "(odometer)", \
      "x and y in mm, heading in deg, as the wheels say; `()` before the first percept") \
    X("stalled", 'u', sensors_stalled, "00", \
      "(stalled)", \
      "TRUE while the body is held up") \
    X("sonar", 'u', sensors_sonar, "02ui", \
      "(sonar [i [otherwise]])", \
      "all ranges in mm, or the one with index i, from 0; `otherwise` where the body has none " \
      "such") \
    X("camera", 'm', sensors_camera, "01k", \
      "(camera [color])", \
      "the blobs in the camera's picture, nearest first, each in four fields: colour (a name " \
      "such as red, else #rrggbb), bearing from straight ahead in deg (left is positive), width " \
      "in deg, range in mm; or those of one colour") \
    X("fiducials", 'm', sensors_fiducials, "00", \
      "(fiducials)", \
      "the things that bear a number, nearest first, each in four fields: number (0: too far to " \
      "read), bearing in deg, range in mm, heading of the thing as seen from here in deg") \
    X("bumpers", 'm', sensors_bumpers, "00", \
      "(bumpers)", \
      "the directions in deg from straight ahead in which something touches the body: of eight, " \
      "45 deg apart") \
    X("battery", 'u', sensors_battery, "00", \
      "(battery)", \
      "what is left, as a share from 0 to 1; FALSE for a body without one") \
    X("gripper", 'u', sensors_gripper, "01k", \
      "(gripper [open|close|lift|lower])", \
      "orders the gripper; TRUE, or FALSE for a body without one.  Without a word its state: " \
      "`(open|closed up|down outer inner holds)`, where outer and inner are TRUE while something " \
      "breaks that beam between the paddles; `()` for a body without one.  Open or closed, up or " \
      "down is what it has come to: it takes its time") \
    X("sonar-data", 'u', sensors_sonar_data, "1*u", \
      "(sonar-data s...)", \
      "clearance in mm: the smallest of these ranges less `?*sonar-margin*`, clipped to " \
      "0..`?*sonar-clip*`; takes numbers and multifields of numbers") \
    X("clear-way", 'm', avoidance_clear_way, "12n", \
      "(clear-way want [far])", \
      "the direction in deg from straight ahead (left is positive) that is nearest to the " \
      "wanted one and free, and the room ahead in mm (less `?*sonar-margin*`), as the front " \
      "eight sonars show them.  Ranges above `?*care*` mm need no care; what is farther off than " \
      "far mm is not in the way.  Keeps to the side to which the body turns already; a body " \
      "with fewer sonars sees nothing") \
    X("speed-to", 'm', motion_speed_to, "55n", \
      "(speed-to x y compass tx ty)", \
      "the speed in mm/s and the turn rate in deg/s that lead to a point, keeping " \
      "`?*follow-distance*` mm away from it") \
    X("plan", 'u', path_plan, "22n", \
      "(plan x y)", \
      "the way to a point round all that stands in the world and never moves: `(x1 y1 x2 y2 " \
      "... x y)` in mm, the corners where it turns and where it ends; FALSE when there is " \
      "none, or the robot was given no map (`--world`)") \
    X("has-map", 'u', path_has_map, "00", \
      "(has-map)", \
      "TRUE if the robot was given a map for plan") \
    X("setSpeed", 'u', motion_set_speed, "22n", \
      "(setSpeed v w)", \
      "drives at v mm/s, turning at w deg/s, clamped to the body's limits; TRUE") \
    X("stop", 'u', motion_stop, "00", \
      "(stop)", \
      "stands still; TRUE") \
    X("update-sensors", 'u', motion_update_sensors, "00", \
      "(update-sensors)", \
      "I have acted, let me see again: ends the step behind this right-hand side; TRUE, on " \
      "the console FALSE")

#define FUNCTIONS_AGENT(X) \
    X("send", 'u', builtins_send, "1*", \
      "(send to field...)", \
      "mail to an agent, a multifield of agents, or an address such as group:scouts; TRUE, or " \
      "FALSE when there is no room.  With an instance as first argument: CLIPS's own send") \
    X("broadcast", 'u', send_broadcast, "0*", \
      "(broadcast field...)", \
      "mail to all agents that are there now; TRUE or FALSE") \
    X("getmsg", 'm', mailbox_getmsg, "00", \
      "(getmsg)", \
      "takes the oldest mail: `(from field...)`, or `()`.  Of mails without a mail fact the " \
      "latest 1024 wait here; when a construct calls getmsg, they are a queue that refuses when " \
      "it is full") \
    X("speak", 'u', speak_send, "3*u", \
      "(speak performative to (create$ field...) key value...)", \
      "mail with its envelope; keys: language ontology reply-with in-reply-to reply-by (a time " \
      "of the run in s) conversation, and ttl (s, after which it expires; without it reply-by), " \
      "layer (a number), priority (low normal high), level (ram logged synced).  Another key is " \
      "an error.  TRUE or FALSE; with reply-with that word") \
    X("tell", 'u', send_tell, "1*", \
      "(tell to field...)", \
      "speak with the performative tell; TRUE or FALSE") \
    X("ask-one", 'u', send_ask_one, "1*", \
      "(ask-one to field...)", \
      "a question for one answer; the word that the answer's in-reply-to bears, or FALSE") \
    X("ask-all", 'u', send_ask_all, "1*", \
      "(ask-all to field...)", \
      "a question for all answers; as ask-one") \
    X("achieve", 'u', send_achieve, "1*", \
      "(achieve to field...)", \
      "a request to make something true; as ask-one") \
    X("reply", 'u', send_reply, "1*", \
      "(reply mail field...)", \
      "answers a mail fact, or in a handler of a layer the mail of that number, with a tell in " \
      "its layer that bears its reply-with and conversation; TRUE or FALSE") \
    X("reply-as", 'u', send_reply_as, "2*u", \
      "(reply-as mail performative field...)", \
      "reply with another performative: `(reply-as ?mail propose price 10)`") \
    X("mail-parameter", 'u', send_mail_parameter, "22u", \
      "(mail-parameter mail key)", \
      "a parameter of a mail fact, or in a handler of a layer of the mail of that number: from " \
      "performative language ontology reply-with in-reply-to conversation layer, and in a " \
      "handler reply-by (a time of the run in s); nil when the sender gave none") \
    X("you-do", 'u', send_you_do, "2*u", \
      "(you-do who command field...)", \
      "makes agents (a name, all, robots, special, a group, or a multifield of names) evaluate " \
      "(command field...), if the trust policy lets it; TRUE or FALSE") \
    X("send-layer", 'u', speak_send_layer, "3*uik", \
      "(send-layer layer performative to field...)", \
      "mail in a layer of your own, from 4 on, or a question in layer 2; as ask-one, and TRUE " \
      "for a performative that is an answer") \
    X("on-layer", 'u', layers_on, "22uik", \
      "(on-layer layer function)", \
      "makes a deffunction the handler of a layer: it is called with `(id from performative " \
      "content)` of each mail of that layer, before the mail becomes a fact.  When it returns " \
      "FALSE the handler that was there before is asked, then what every agent can do; anything " \
      "else: it has taken the mail.  May stand outside of rules in a rule file") \
    X("on-resolve", 'u', layers_on_resolve, "22k", \
      "(on-resolve scheme function)", \
      "makes this agent the resolver of the addresses `scheme:rest`: the deffunction is called " \
      "with `(rest sender)`, rest a number or a symbol.  It returns the receivers: a name, a " \
      "multifield of names, or FALSE when there is no such address.  An agent resolves one " \
      "scheme, a later call replaces it.  May stand outside of rules in a rule file; TRUE or " \
      "FALSE") \
    X("group-create", 'u', directory_create, "11k", \
      "(group-create group)", \
      "makes a group without members; TRUE or FALSE.  A change takes effect when the broker has " \
      "it; what it refuses becomes a fact: `(event refused group-create scouts group-exists)`") \
    X("group-join", 'u', directory_join, "11k", \
      "(group-join group)", \
      "enters a group, and makes it if it is not there; TRUE or FALSE") \
    X("group-leave", 'u', directory_leave, "11k", \
      "(group-leave group)", \
      "leaves a group; TRUE or FALSE") \
    X("group-send", 'u', send_group, "1*uk", \
      "(group-send group field...)", \
      "mail to all members but this agent; TRUE or FALSE") \
    X("groups", 'm', directory_groups, "00", \
      "(groups)", \
      "the names of all groups") \
    X("members", 'm', directory_members, "11k", \
      "(members group)", \
      "the names of its members; `()` for a group that is not there") \
    X("advertise", 'u', directory_advertise, "1*uk", \
      "(advertise service key value...)", \
      "offers a service with these attributes: symbols, strings without blanks, numbers; offered " \
      "again, they are replaced.  The key lease is no attribute: so many s the offer stands " \
      "unless it is renewed.  ttl, reply-by, lease-time and expires are errors.  TRUE or FALSE") \
    X("withdraw", 'u', directory_withdraw, "11k", \
      "(withdraw service)", \
      "no longer offers it; TRUE or FALSE") \
    X("find-service", 'm', directory_find_service, "1*", \
      "(find-service service constraint...)", \
      "the names of the agents that offer it and are not absent: `(find-service " \
      "mapper role=scout battery>=0.5 near=2.5,-1,3)`, the last at most 3 m from there by the " \
      "attributes x and y; `*` is any service") \
    X("send-role", 'u', send_role, "1*uk", \
      "(send-role role field...)", \
      "mail to the agents that have a role; TRUE or FALSE") \
    X("send-task", 'u', send_task, "1*uk", \
      "(send-task task field...)", \
      "mail to the agents that do a task; TRUE or FALSE") \
    X("send-near", 'u', send_near, "1*un", \
      "(send-near mm field...)", \
      "mail to the agents within so many mm; TRUE or FALSE") \
    X("my-name", 'u', directory_my_name, "00", \
      "(my-name)", \
      "this agent's name") \
    X("lookup", 'u', directory_lookup, "11k", \
      "(lookup name)", \
      "`(name kind state host)` from the white pages, or FALSE; host is the platform on which it " \
      "lives, or an empty string") \
    X("listing", 'm', directory_listing, "00", \
      "(listing)", \
      "the names of all agents") \
    X("moveTo", 'u', lifecycle_move, "11k", \
      "(moveTo host)", \
      "moves to another platform when this right-hand side is over, which ends the step; TRUE.  " \
      "When it may not, or cannot, the agent goes on here: `(event refused moveTo north " \
      "unknown-host)`") \
    X("clone", 'u', lifecycle_clone, "12k", \
      "(clone name [host])", \
      "likewise makes a copy of this agent with a name of its own, there or here; TRUE") \
    X("dispose", 'u', lifecycle_dispose, "00", \
      "(dispose)", \
      "likewise ends this agent for good; TRUE") \
    X("failures", 'm', lifecycle_failures, "00", \
      "(failures)", \
      "each rule that has ended in an error or was stopped by a guard, and how often: `(rule " \
      "count ...)`.  A rule that fails too often suspends the robot; to resume it begins to " \
      "count anew") \
    X("set-aside", 'm', directory_aside, "00", \
      "(set-aside)", \
      "the lines that are set aside, as they begin: the agent has died of each of them twice, " \
      "and does not carry it out again ([crashes.md](../crashes.md))") \
    X("drop-aside", 'u', directory_drop_aside, "11i", \
      "(drop-aside n)", \
      "takes the n-th of them off the list, counted from 1; FALSE when there is none") \
    X("run", 'u', lifecycle_run, "01i", \
      "(run [n])", \
      "on the console: leaves standby, or goes on after suspend or a break; with a number, as " \
      "step; in rules: nothing") \
    X("resume", 'u', lifecycle_run, "00", \
      "(resume)", \
      "the same as run") \
    X("continue", 'u', lifecycle_run, "00", \
      "(continue)", \
      "the same as run: the rule that the agent stands before fires") \
    X("step", 'u', lifecycle_step, "01i", \
      "(step [n])", \
      "on the console: fires n rules, or one, in as many control steps as that takes, and " \
      "suspends then; in rules: nothing") \
    X("suspend", 'u', lifecycle_suspend, "00", \
      "(suspend)", \
      "stands still until it is resumed; in a rule, when the step is over")

#define FUNCTIONS_EXTENSIONS(X) \
    X("findall", 'm', query_findall, NULL, \
      "(findall (relation field...))", \
      "the facts that match; `?` and `$?` as in a pattern, slots of a template as `(slot " \
      "field...)`") \
    X("fact-fields", 'm', query_fields, "11", \
      "(fact-fields fact)", \
      "the fields of an ordered fact, given by address or index") \
    X("sind", 'u', math_sind, "11n", \
      "(sind a)", \
      "sine of an angle in deg") \
    X("cosd", 'u', math_cosd, "11n", \
      "(cosd a)", \
      "cosine of an angle in deg") \
    X("tand", 'u', math_tand, "11n", \
      "(tand a)", \
      "tangent of an angle in deg") \
    X("asind", 'u', math_asind, "11n", \
      "(asind x)", \
      "arc sine in deg") \
    X("acosd", 'u', math_acosd, "11n", \
      "(acosd x)", \
      "arc cosine in deg") \
    X("atand", 'u', math_atand, "11n", \
      "(atand x)", \
      "arc tangent in deg") \
    X("atan2d", 'u', math_atan2d, "22n", \
      "(atan2d y x)", \
      "direction of (x, y) in deg") \
    X("norm-angle", 'u', math_norm_angle, "11n", \
      "(norm-angle a)", \
      "the same angle in (-180, 180]") \
    X("distance", 'u', math_distance, "44n", \
      "(distance x1 y1 x2 y2)", \
      "between two points") \
    X("bearing", 'u', math_bearing, "44n", \
      "(bearing x1 y1 x2 y2)", \
      "direction from the first point to the second, in deg") \
    X("clamp", 'u', math_clamp, "33n", \
      "(clamp x lo hi)", \
      "x, or the limit that it is beyond; whole when all three are") \
    X("now", 'u', math_now, "00", \
      "(now)", \
      "simulated time in s") \
    X("time", 'u', math_now, "00", \
      "(time)", \
      "the same as now: rules see no other clock") \
    X("random", 'u', math_random, "02i", \
      "(random [lo hi])", \
      "a whole number, lo and hi included; without them 0 to 2147483647; a stream of each " \
      "agent's own") \
    X("seed", 'u', math_seed, "11i", \
      "(seed n)", \
      "starts this agent's random numbers again") \
    X("div", 'u', math_div, "2*n", \
      "(div a b...)", \
      "whole division") \
    X("mod", 'u', math_mod, "22n", \
      "(mod a b)", \
      "remainder, with the sign of a")
/* clang-format on */

#define X(name, code, function, arguments, usage, text) void function(void *env, DATA_OBJECT *out);
FUNCTIONS_PHYSICAL(X)
FUNCTIONS_AGENT(X)
FUNCTIONS_EXTENSIONS(X)
#undef X

/* sensors.c */

/** @return whether the mind has a body, or had no step yet; else after a CLIPS error */
bool sensors_have_body(void *env, const char *function);

/** Reads a plain list of the percept: the row of mu_channels that is the function's context. */
void sensors_list(void *env, DATA_OBJECT *out);

/* query.c */
struct expr *query_parse(void *env, struct expr *top, const char *source);

/* send.c */

/* An empty letter. */
extern const struct mind_letter send_blank;

/** Evaluates the arguments from first on, as one multifield.  @return false, after a CLIPS error */
bool send_fields(void *env, const char *function, int first, DATA_OBJECT *fields);

/**
 * Reads the addressee of a mail: a name, an address, or a multifield of names.
 *
 * @param wanted  the text of a CLIPS error
 * @return the address, until the next call; NULL, after a CLIPS error
 */
const char *send_address(void *env, const char *function, int index, const char *wanted);

/** Writes a new word for the reply-with of a question.  @return to */
const char *send_question(void *env, char *to, size_t size);

/** Reads a performative into a letter.  @return false, after a CLIPS error */
bool send_performative(void *env, const char *function, int index, struct mind_letter *letter);

/** Reads a number of seconds above 0, of a key.  @return false, after a CLIPS error */
bool send_seconds(void *env, const char *function, int index, const char *key, uint64_t *ns);

/**
 * Hands a letter over.  The result is FALSE without room, else TRUE or the word that the answer
 * bears.
 */
void send_hand(void *env, const struct mind_letter *letter, DATA_OBJECT *out);

/** (send WHO field...) to an agent; the instance case is taken before. */
void send_agent(void *env, DATA_OBJECT *out);

#endif
