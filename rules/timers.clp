; SPDX-License-Identifier: Apache-2.0
;
; (after SECONDS WORD...): once the time is over, the fact (timeout WORD...) is there, until a rule
; retracts it.  (after SECONDS "(CALL)"): the call is evaluated then.  (every SECONDS ...) again and
; again.  Both return the words of the timer, by which (cancel WORD...) ends it.  Simulated time where
; there is any, looked at in each step.

(deffunction cancel ($?what)
  (progn$ (?timer (findall (timer $?)))
    (if (eq (rest$ (rest$ (fact-fields ?timer))) ?what) then
      (retract ?timer))))

(deffunction after (?seconds $?what)
  (assert (timer (+ (now) ?seconds) 0 $?what))
  ?what)

(deffunction every (?seconds $?what)
  (assert (timer (+ (now) ?seconds) ?seconds $?what))
  ?what)

(deffunction timer-again (?at ?again ?time $?what)
  "The next of its times; those that it has missed are left out."
  (bind ?next (+ ?at ?again))
  (if (<= ?next ?time) then
    (bind ?next (+ ?at (* ?again (+ 1 (integer (/ (- ?time ?at) ?again)))))))
  (assert (timer ?next ?again $?what)))

(defrule timer-over
  (declare (salience 50))
  ?timer <- (timer ?at ?again $?what)
  (position ?time&:(>= ?time ?at) $?)
  =>
  (retract ?timer)
  (assert (timeout $?what))
  (if (> ?again 0) then
    (timer-again ?at ?again ?time $?what)))

; The same without a body: such an agent has the time of each step in a fact of its own.  The rules
; stay in this order, which is that of what they bring about.
(defrule timer-over-without-body
  (declare (salience 50))
  ?timer <- (timer ?at ?again $?what)
  (tick ?time&:(>= ?time ?at))
  =>
  (retract ?timer)
  (assert (timeout $?what))
  (if (> ?again 0) then
    (timer-again ?at ?again ?time $?what)))

(defrule timer-calls
  (declare (salience 50))
  ?timeout <- (timeout ?call&:(stringp ?call))
  (test (eq (sub-string 1 1 ?call) "("))
  =>
  (retract ?timeout)
  (eval ?call))
