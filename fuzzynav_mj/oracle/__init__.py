"""Whether a contact-free run exists at all, judged with every obstacle's motion known."""

from fuzzynav_mj.oracle.possibility import Possibility, assess

__all__ = ["Possibility", "assess"]
