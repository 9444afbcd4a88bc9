//! Columns of text dumps: the attributes of their line, and their names and formats in `dump_modify`.

use super::attribute::{Attribute, expand};
use super::base::OfFile;
use perigrain_base::diag::Result;
use perigrain_lang::Word;
use perigrain_styles::BuildCx;
use perigrain_styles::words::{At, Or, Words};

/// The line of a dump of attributes.
#[derive(Words)]
pub struct Columns {
    #[word(flatten)]
    pub target: OfFile,
    /// The attributes of `dump custom`.
    #[word(name = "attribute", what = "a particle attribute such as id or x", kind = Kind::Attribute, least = 1)]
    pub attributes: Vec<Word>,
}

impl Columns {
    /// What each column holds.
    ///
    /// # Errors
    /// Unknown attributes.
    pub fn attributes(&self, cx: &BuildCx) -> Result<Vec<Attribute>> {
        let all = self.attributes.iter().map(|word| expand(word, cx)).collect::<Result<Vec<_>>>()?;
        Ok(all.concat())
    }
}

/// The format of a column, or of several.
pub type ColumnFormat = Or<OfColumns, OfColumn>;

/// The format of several columns.
#[derive(Words)]
pub enum OfColumns {
    /// One conversion for each column, in quotes.
    Line(#[word(name = "\"…\"", what = "a format such as %g")] Word),
    /// Of all columns with whole numbers.
    Int(#[word(name = "%d", what = "a format such as %g")] Word),
    /// Of all columns with other numbers.
    Float(#[word(name = "%g", what = "a format such as %g")] Word),
    /// As without any `format`.
    None,
}

/// The format of one column.
#[derive(Words)]
pub struct OfColumn {
    #[word(name = "N", what = "line, int, float, a column or none")]
    pub column: Word,
    #[word(name = "%…", what = "a format such as %g")]
    pub format: Word,
}

/// The keywords of `dump_modify` that this dump has beside those of all.
#[derive(Words)]
pub struct Formatted {
    /// How numbers are written.
    #[word(keyword, name = "format", what = "line, int, float, a column or none")]
    pub format: Vec<At<ColumnFormat>>,
}

/// The same, with the time.
#[derive(Words)]
pub struct Timed {
    #[word(flatten)]
    pub formatted: Formatted,
    /// The time stands at the head of each snapshot.
    #[word(keyword, what = "time")]
    pub time: Option<bool>,
}

/// The same, with titles.
#[derive(Words)]
pub struct Table {
    #[word(flatten)]
    pub timed: Timed,
    /// The name of a column; `default` gives all columns their own names again.
    #[word(keyword, name = "title", what = "a column or default")]
    pub colname: Vec<Or<Usual, Renamed>>,
    /// Snapshots have a header.
    #[word(keyword, what = "header")]
    pub header: Option<bool>,
    /// The unit system stands in the first header.
    #[word(keyword, what = "units")]
    pub units: Option<bool>,
}

/// As without the keyword.
#[derive(Words)]
pub enum Usual {
    Default,
}

/// A column's new name.
#[derive(Words)]
pub struct Renamed {
    #[word(name = "N", what = "a column or default")]
    pub column: Word,
    #[word(what = "the column's new name")]
    pub name: String,
}
