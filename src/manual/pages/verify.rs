//! The page about published cases that the program runs by itself.

use super::Entry;
use perigrain_styles::Doc;
use perigrain_styles::words::Syntax;

pub(super) const VERIFY: Entry = (
    "verify",
    Doc {
        syntax: Syntax::Written(
            "perigrain verify [-list] [-only PATTERN] [-deck] [-threads N] [-json FILE] [-junit FILE] [-html FILE] [-markdown FILE]",
        ),
        summary: "Published cases and closed forms, run by the program, with a verdict in the exit code.",
        text: TEXT,
        example: "perigrain verify -list\n\
            perigrain verify -only pull_off -html pull_off.html\n\
            perigrain verify -only peridynamics/dispersion -deck\n\
            perigrain verify -threads 2 -only bonded/one -json bonds.json -junit bonds.xml",
    },
);

const TEXT: &str = "Does this build on this machine give the numbers of the field? The program carries decks of published cases and of \
    scenes with closed forms: impacts of spheres (Chung and Ooi's eight tests), restitution, rolling, adhesion; lattice moduli, \
    waves, stable steps and cracks of peridynamic solids; beam bonds, chains, the stiffness of bonded bodies. `verify` runs them all, in less than two \
    minutes on two cores, and prints for each number what was expected, what came out, by how much it is off and how much is allowed. Nothing is read or written but \
    the reports asked for. What came out on one machine stands in [Verification](../verification.md).\n\n\
    Each number ends in one of three ways:\n\n\
    - `passed`: within its tolerance, which is stated with a reason;\n\
    - `known deviation`: outside of it, by as much as is known, with the reason why perigrain does not give the number. Any other wrong number at \
    this place fails;\n\
    - `FAILED`: anything else; also every number of a deck that does not come to its end.\n\n\
    The exit code is 0 if nothing failed (known deviations are counted and listed, and do not fail), 1 if something did, 2 if the command line is wrong.\n\n\
    - `-list` prints names and titles instead;\n\
    - `-only PATTERN` takes the cases whose name or title holds the text PATTERN, upper or lower case;\n\
    - `-deck` prints their decks, which run by themselves too (`perigrain verify -only pull_off -deck > in.pull_off`);\n\
    - `-threads N` runs N cases at a time (all cores); numbers do not depend on it;\n\
    - `-json FILE`, `-junit FILE`, `-html FILE`, `-markdown FILE` write the report: all numbers and curves for programs; a test per number, known deviations as skipped; one page \
    with curves that needs nothing else; tables.\n\n\
    Lines that begin with `#|` at the head of such a deck are a TOML document that says what must come out and from which source it is known. A line printed as `curve NAME x y [expected]` is a point of a curve.";
