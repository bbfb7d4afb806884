; SPDX-License-Identifier: Apache-2.0
; Scripts that CLIPS runs as a program and inside a robot: tests/rules/engine/run.

;;; classes
(defclass P (is-a USER) (slot n (default 1)))
(definstances i (p1 of P) (p2 of P (n 5)))
(defrule r (object (is-a P) (n ?n)) => (printout t ?n crlf))

;;; messages
(defclass P (is-a USER) (slot n (default 1)))
(defmessage-handler P up (?k) (bind ?self:n (+ ?self:n ?k)))
(definstances i (p of P))
(defrule r => (send [p] up 4) (printout t (send [p] get-n) crlf))

;;; inheritance
(defclass A (is-a USER) (slot x (default 1)))
(defclass B (is-a A) (slot y (default 2)))
(defmessage-handler A hello () (printout t A crlf))
(defmessage-handler B hello () (printout t B crlf) (call-next-handler))
(defrule r => (make-instance b of B) (send [b] hello) (printout t (send [b] get-x) crlf))

;;; before and after
(defclass A (is-a USER))
(defmessage-handler A go before () (printout t before crlf))
(defmessage-handler A go () (printout t go crlf))
(defmessage-handler A go after () (printout t after crlf))
(defrule r => (make-instance a of A) (send [a] go))

;;; queries
(defclass A (is-a USER) (slot n))
(definstances i (a of A (n 1)) (b of A (n 7)) (c of A (n 9)))
(defrule r => (do-for-all-instances ((?x A)) (> ?x:n 5) (printout t ?x:n crlf)))

;;; changed in rules
(defclass A (is-a USER) (slot n (default 0)))
(definstances i (a of A))
(defrule r ?o <- (object (is-a A) (n ?n&:(< ?n 3))) => (printout t ?n crlf) (modify-instance ?o (n (+ ?n 1))))

;;; multislots
(defclass A (is-a USER) (multislot m (default a b)))
(definstances i (x of A))
(defrule r => (slot-insert$ [x] m 2 z) (printout t (send [x] get-m) crlf))

;;; deleted
(defclass A (is-a USER))
(definstances i (x of A))
(defrule r => (printout t (instance-existp [x])) (send [x] delete) (printout t (instance-existp [x]) crlf))
