; SPDX-License-Identifier: Apache-2.0
;
; A monitor that keeps the books of a contract net: it hears every mail and asks nobody.  Of each job
; it says who got it, for what way, and what way that one really went; and who breaks the protocol.
; experiments/contract-net.yaml starts it.

(defrule propose
  (mail-seen (performative propose) (from ?who) (conversation ?job) (content cost ?cost))
  =>
  (assert (proposal ?job ?who ?cost)))

(defrule award
  (mail-seen (performative accept-proposal) (to ?who) (conversation ?job))
  (proposal ?job ?who ?cost)
  (step (time ?time))
  (robot (name ?who) (distance ?gone))
  =>
  (assert (contract ?job ?who ?cost ?time ?gone))
  (format t "%5.1f s: %s is %s's, for %.1f m%n" ?time ?job ?who (/ ?cost 1000)))

(defrule award-was-dear
  (contract ?job ?who ?cost $?)
  (proposal ?job ?other ?less&:(< ?less ?cost))
  =>
  (format t "         %s had offered %.1f m%n" ?other (/ ?less 1000)))

(defrule finish
  (mail-seen (performative inform) (from ?who) (conversation ?job))
  ?contract <- (contract ?job ?who ? ?since ?before)
  (step (time ?time))
  (robot (name ?who) (distance ?gone))
  =>
  (retract ?contract)
  (assert (finished ?job))
  (format t "%5.1f s: %s is done by %s, after %.1f s and %.1f m%n"
          ?time ?job ?who (- ?time ?since) (/ (- ?gone ?before) 1000)))

; A job that failed is called anew: what was offered for it is void.
(defrule fail
  (mail-seen (performative failure) (from ?who) (conversation ?job))
  ?contract <- (contract ?job ?who $?)
  (step (time ?time))
  =>
  (retract ?contract)
  (progn$ (?offer (findall (proposal ?job ? ?)))
    (retract ?offer))
  (format t "%5.1f s: %s gives up %s%n" ?time ?who ?job))

(defrule accept-without-offer
  (mail-seen (performative accept-proposal) (to ?who) (conversation ?job))
  (not (proposal ?job ?who ?))
  (step (time ?time))
  =>
  (format t "%5.1f s: %s did not propose to do %s, and is to%n" ?time ?who ?job))

(defrule inform-without-contract
  (declare (salience -1))
  (mail-seen (performative inform) (from ?who) (conversation ?job&~nil))
  (not (contract ?job ?who $?))
  (not (finished ?job))
  (step (time ?time))
  =>
  (format t "%5.1f s: %s says of %s what nobody gave it%n" ?time ?who ?job))

(defrule summary
  (run-ended (how ?how))
  (not (summed-up))
  =>
  (assert (summed-up))
  (printout t (length$ (findall (finished ?))) " jobs are done, "
              (length$ (findall (contract $?))) " are under way" crlf))
