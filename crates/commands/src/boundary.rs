//! `boundary`: what the faces of the box do.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_styles::common::{before_box, setting};
use perigrain_styles::words::{Kind, Syntax, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::{Boundary, Face};

/// The command.
pub struct BoundaryCommand;

impl Style for BoundaryCommand {
    fn name(&self) -> &'static str {
        "boundary"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Says what the faces of the box do: periodic, fixed or shrink-wrapped.",
            text: "Each of X, Y, Z is one letter for both faces or two letters for the lower and the upper one: `p` periodic \
                   (always both), `f` fixed, `s` shrink-wrapped, `m` shrink-wrapped but never inside the box as created. Shrinking \
                   and wrapping happen when neighbour lists are rebuilt. Default: `p p p`.",
            example: "boundary f fs p",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(flatten)]
    faces: AllFaces,
}

/// The faces of all three dimensions.
#[derive(Words)]
pub struct AllFaces {
    #[word(name = "X", what = "the faces in x")]
    x: Faces,
    #[word(name = "Y", what = "the faces in y")]
    y: Faces,
    #[word(name = "Z", what = "the faces in z")]
    z: Faces,
}

impl From<AllFaces> for Boundary {
    fn from(AllFaces { x, y, z }: AllFaces) -> Self {
        Self([x.0, y.0, z.0])
    }
}

/// The faces of a dimension as one or two letters.
struct Faces([Face; 2]);

impl Value for Faces {
    const KIND: Kind = Kind::Text;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let word = args.expect(what)?;
        let face = |c: char| match c {
            'p' => Some(Face::Periodic),
            'f' => Some(Face::Fixed),
            's' => Some(Face::Shrink),
            'm' => Some(Face::ShrinkMin),
            _ => None,
        };
        let letters: Vec<Option<Face>> = word.text.chars().map(face).collect();
        let pair = match letters.as_slice() {
            [Some(both)] => [*both, *both],
            [Some(lo), Some(hi)] => [*lo, *hi],
            _ => {
                let text = format!("`{}` is no boundary: one or two of the letters p f s m", word.text);
                return fail(Code::BAD_VALUE, word.span, text);
            }
        };
        if (pair[0] == Face::Periodic) != (pair[1] == Face::Periodic) {
            return fail(Code::BAD_VALUE, word.span, "both faces of a dimension are periodic or neither is");
        }
        Ok(Self(pair))
    }
}

impl CommandStyle for BoundaryCommand {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        before_box(cx, "boundary")?;
        let Line { faces } = read(a, cx)?;
        let boundary = Boundary::from(faces);
        Ok(setting(move |cx| {
            cx.world.settings.boundary = boundary;
            Ok(())
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{refused, scene};

    #[test]
    fn one_or_two_letters() {
        assert_eq!(scene("boundary f fs p").settings.boundary.letters(), "ff fs pp");
        let empty = Default::default();
        assert_eq!(refused(&empty, "boundary p pf f").0, "pf");
        assert_eq!(refused(&empty, "boundary p q f").0, "q");
        assert!(refused(&empty, "boundary p p").1.contains("the faces in z"));
    }
}
