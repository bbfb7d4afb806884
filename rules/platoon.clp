; SPDX-License-Identifier: Apache-2.0
;
; Platoons: a layer of mail above KQML.  A robot leads, others ask to join, and each follows the one
; before it.  (lead), (join NAME) and (quit) are the commands.
;
; Layer 5 speaks of places in a row.  What a place means is done below it: a member follows another
; robot, a question for the row is answered in layer 3, and layer 1 keeps the leader from being
; suspended while others follow it.

(defglobal
  ?*leader* = nil        ; whose platoon it is in; nil: none
  ?*row* = (create$))    ; the leader's: itself, then the members in order

(deffacts beginning
  (goal stay))

(deffunction lead ()
  (bind ?*leader* ?*my-name*)
  (bind ?*row* (create$ ?*my-name*))
  (wander))

; --- commands of a member: a request in layer 5 -----------------------------------------------

(deffunction join (?leader)
  (speak request ?leader (create$ join) layer 5 ontology platoon conversation ?leader
         reply-with (sym-cat join- ?*my-name*) ttl 5))

(deffunction quit ()
  (if (and (neq ?*leader* nil) (neq ?*leader* ?*my-name*)) then
    (speak request ?*leader* (create$ quit) layer 5 ontology platoon conversation ?*leader*
           reply-with (sym-cat quit- ?*my-name*))))

; --- layer 5, the leader's side ---------------------------------------------------------------

; The last of the row is the one that a new member follows.
(deffunction take-in (?id ?from)
  (bind ?last (nth$ (length$ ?*row*) ?*row*))
  (bind ?*row* (create$ ?*row* ?from))
  (reply-as ?id agree follow ?last))

; The one behind a member that quits follows the one before it: told in the same conversation.
(deffunction let-go (?id ?from ?place)
  (bind ?before (nth$ (- ?place 1) ?*row*))
  (if (< ?place (length$ ?*row*)) then
    (speak inform (nth$ (+ ?place 1) ?*row*) (create$ follow ?before) layer 5 ontology platoon
           conversation (mail-parameter ?id conversation)))
  (bind ?*row* (delete$ ?*row* ?place ?place))
  (reply-as ?id agree quit))

(deffunction platoon-request (?id ?from ?content)
  (bind ?place (member$ ?from ?*row*))
  (if (neq ?*leader* ?*my-name*) then
    (return (reply-as ?id refuse no-leader)))
  (if (and (eq ?content (create$ join)) (not ?place)) then
    (return (take-in ?id ?from)))
  (if (and (eq ?content (create$ quit)) ?place) then
    (return (let-go ?id ?from ?place)))
  (reply-as ?id not-understood ?content))

; --- layer 5, the member's side ---------------------------------------------------------------

(deffunction platoon-place (?id ?content)
  (if (eq (nth$ 1 ?content) follow) then
    (bind ?*leader* (mail-parameter ?id conversation))
    (follow (nth$ 2 ?content))
   else
    (bind ?*leader* nil)
    (wander))
  TRUE)

; What comes in layer 5: requests to the leader, places for members.  Another ontology is passed on.
(deffunction platoon (?id ?from ?performative ?content)
  (if (neq (mail-parameter ?id ontology) platoon) then
    (return FALSE))
  (switch ?performative
    (case request then (platoon-request ?id ?from ?content))
    (case agree then (platoon-place ?id ?content))
    (case inform then (platoon-place ?id ?content))
    (case refuse then (printout t ?from " refuses: " (implode$ ?content) crlf) TRUE)
    (default FALSE)))

(on-layer 5 platoon)

; --- what it overrides below ------------------------------------------------------------------

; Layer 3: (ask-one red row) is answered by KQML's tell, as any question of a robot.
(deffunction answer-row ()
  ?*row*)

; Layer 1: a leader with members refuses a request to suspend.  A directive never comes here.
(deffunction leader-stays (?id ?from ?performative ?content)
  (if (and (eq ?performative suspend) (> (length$ ?*row*) 1)) then
    (reply-as ?id refuse suspend ?*row*)
   else
    FALSE))

(on-layer 1 leader-stays)

; Somebody's answers, for whoever looks.
(defrule hear-answer
  (declare (salience 20))
  ?mail <- (mail (from ?from) (layer ?layer) (performative ?what) (in-reply-to ~nil)
                 (content $?content))
  =>
  (retract ?mail)
  (printout t ?from " in layer " ?layer ": " ?what " " (implode$ ?content) crlf))
