//! Rows of the step table during a run.

use super::{Source, Thermo};
use crate::graph::ops::Lost;
use crate::graph::row::Row;
use crate::graph::seal::Sealer;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_lang::ValueRef;
use perigrain_output::log::Log;
use perigrain_output::thermo::Column;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::SealCx;
use perigrain_world::{Face, World};

impl Thermo {
    /// At which steps a row is printed.
    ///
    /// # Errors
    /// A variable that is gone.
    pub fn when(&self, s: &mut Sealer) -> Result<When> {
        let ends = vec![When::First, When::Last];
        Ok(match (&self.named, self.every) {
            (Some(r), _) => When::Any([vec![s.steps(r)?], ends].concat()),
            (None, 0) => When::Any(ends),
            (None, n) => When::Any([vec![When::Every(n)], ends].concat()),
        })
    }

    /// Refuses a fix whose values are not new at the steps of rows.
    fn compatible(&self, s: &Sealer, r: &ValueRef) -> Result<()> {
        let every = s.fix_interval(r);
        if self.named.is_some() || every <= 1 || self.every % every == 0 {
            return Ok(());
        }
        let text =
            format!("`{r}` is new every {every} steps only, and thermo output comes every {}", self.every);
        let help = format!("let the interval of `thermo` be a multiple of {every}");
        Err(Diagnostic::error(Code::CONFLICT, r.span, text).help(help).into())
    }

    /// The op that prints rows, with its values requested.
    ///
    /// # Errors
    /// Columns that name what no longer exists.
    pub fn op(&self, s: &mut Sealer, log: Log) -> Result<Box<dyn Op>> {
        let when = self.when(s)?;
        let mut layout = self.layout.clone();
        layout.norm = self.normalized(s.world());
        let mut sources = self.sources.clone();
        if self.built_in && (s.deforms() || box_changes(s.world())) {
            layout.columns.extend(Column::keyword("vol"));
            sources.push(Source::Keyword("vol".into(), Span::default()));
        }
        let mut readings = vec![];
        let judged = |source: &Source| match source {
            Source::Ref(r) if s.is_open(r) => Some(r.span),
            _ => None,
        };
        let spans = sources.iter().map(judged).collect();
        for source in &sources {
            readings.push(match source {
                Source::Keyword(name, span) => s.keyword_total(name, *span, Stage::Output, &when)?,
                Source::Ref(r) => {
                    self.compatible(s, r)?;
                    s.value(r, Stage::Output, &when)?
                }
            });
        }
        Ok(Box::new(Row {
            layout,
            readings,
            spans,
            when,
            log,
            warn: self.lost == Lost::Warn,
            shown: usize::MAX,
        }))
    }
}

/// Whether a face of the box follows the particles.
fn box_changes(w: &World) -> bool {
    let follows = |f: &Face| matches!(f, Face::Shrink | Face::ShrinkMin);
    w.domain.as_ref().is_some_and(|d| d.boundary.0.iter().flatten().any(follows))
}
