//! Variables of style `python`: functions of a program that hosts the session, and their declaration by the command `python`.

use super::{Data, Vars};
use crate::args::{Args, blame};
use crate::command::Word;
use crate::expr::Trail;
use crate::number::{self, value_text};
use crate::reference::{RefKind, ValueRef};
use crate::value::{Env, Value};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use std::collections::BTreeMap;
use std::fmt::Debug;
use std::sync::Arc;

/// A program that has functions in Python.
///
/// It is no state of a session: copies talk to the same program, and no file holds it.
pub trait Functions: Debug + Send + Sync {
    /// Executes code at the top level of the program's names.
    ///
    /// # Errors
    /// The program's own words on why it failed.
    fn execute(&self, code: &str, name: &str) -> std::result::Result<(), String>;

    /// Whether there is a function of this name.
    fn has(&self, function: &str) -> bool;

    /// Calls a function.
    ///
    /// # Errors
    /// As [`Functions::execute`].
    fn call(&self, function: &str, given: &[Given]) -> std::result::Result<Given, String>;
}

/// What a function is given, and what it gives back.
#[derive(Clone, Debug, PartialEq)]
pub enum Given {
    /// A whole number.
    Whole(i64),
    /// Any number.
    Real(f64),
    /// A text.
    Text(String),
    /// Nothing.
    Nothing,
}

impl Given {
    /// As it stands in a line of a deck.
    pub(super) fn text(self) -> String {
        match self {
            Given::Whole(k) => k.to_string(),
            Given::Real(a) => value_text(a),
            Given::Text(text) => text,
            Given::Nothing => String::new(),
        }
    }
}

/// An argument of a function, at its place in the command.
#[derive(Clone, Debug)]
enum Input {
    Word(String),
    Variable(String),
}

/// A function that the command `python` has made known.
#[derive(Clone, Debug)]
pub struct Function {
    inputs: Vec<(Input, char)>,
    /// The variable that has what comes back, and its kind.
    gives: Option<(String, char)>,
}

/// The request of a `python` command.
#[derive(Debug)]
pub enum PythonCommand<'a> {
    /// A function is made known, after code if there is some.
    Known(String, Function, Option<Source<'a>>),
    /// A function is called.
    Invoked(String),
    /// Code is executed.
    Source(Source<'a>),
}

/// Code of the command `python`.
#[derive(Clone, Copy, Debug)]
pub enum Source<'a> {
    /// In a file.
    File(&'a Word),
    /// In the deck.
    Here(&'a Word),
}

const KEYS: [&str; 7] = ["input", "return", "format", "length", "file", "here", "exists"];

/// Reads the words behind `python`.
///
/// # Errors
/// Every mistake in them.
pub fn read_command<'a>(args: &mut Args<'a>) -> Result<PythonCommand<'a>> {
    let name = args.expect("a function's name, or source")?;
    if name.text == "source" {
        let word = args.expect("a file, or here with code")?;
        let code =
            if word.text == "here" { Source::Here(args.expect("the code")?) } else { Source::File(word) };
        args.finish()?;
        return Ok(PythonCommand::Source(code));
    }
    if args.eat("invoke") {
        args.finish()?;
        return Ok(PythonCommand::Invoked(name.text.clone()));
    }
    let (mut inputs, mut gives, mut code, mut there) = (vec![], None, None, false);
    let mut format: Option<&Word> = None;
    while let Some(key) = args.next() {
        match key.text.as_str() {
            "input" => {
                let count = args.integer_from(0, "how many values the function is given")?;
                for _ in 0..count {
                    inputs.push(input(args.expect("a value, or v_name")?)?);
                }
            }
            "return" => {
                let word = args.expect("v_name")?;
                match word.text.strip_prefix("v_") {
                    Some(variable) => gives = Some(variable.to_string()),
                    None => return Err(blame(word, Code::BAD_VALUE, "what comes back goes to v_name").into()),
                }
            }
            "format" => format = Some(args.expect("a letter for each value: i, f or s")?),
            // Texts have any length here.
            "length" => {
                args.integer_from(1, "the greatest length of a text")?;
            }
            "file" => code = Some(Source::File(args.expect("a file")?)),
            "here" => code = Some(Source::Here(args.expect("the code")?)),
            "exists" => there = true,
            _ => return Err(args.unknown(key, &KEYS)),
        }
    }
    if code.is_none() && !there {
        let d =
            Diagnostic::error(Code::MISSING_ARGUMENT, args.here(), "where the function stands is missing");
        return Err(d.help("`file NAME`, `here \"\"\"code\"\"\"`, or `exists` if the program has it").into());
    }
    let kinds = kinds(format, inputs.len() + usize::from(gives.is_some()), args.here())?;
    let gives = gives.zip(kinds.get(inputs.len()).copied());
    let inputs = inputs.into_iter().zip(kinds).collect();
    Ok(PythonCommand::Known(name.text.clone(), Function { inputs, gives }, code))
}

fn input(word: &Word) -> Result<Input> {
    if word.text == "SELF" {
        let d = blame(
            word,
            Code::NOT_SUPPORTED,
            "a function cannot have the scene, which is at work while it is called",
        );
        return Err(d.help("give it the values that it needs, as v_name").into());
    }
    let variable = word.text.strip_prefix("v_").or_else(|| word.text.strip_prefix("iv_"));
    Ok(match variable {
        Some(name) => Input::Variable(name.to_string()),
        None => Input::Word(word.text.clone()),
    })
}

/// A letter for each value.
fn kinds(format: Option<&Word>, count: usize, end: Span) -> Result<Vec<char>> {
    let Some(word) = format else {
        if count == 0 {
            return Ok(vec![]);
        }
        return fail(Code::MISSING_ARGUMENT, end, "`format` is missing: a letter for each value, i, f or s");
    };
    let kinds: Vec<char> = word.text.chars().collect();
    if let Some(other) = kinds.iter().find(|k| !"ifs".contains(**k)) {
        let text = format!("`{other}` is none of i (whole numbers), f (numbers), s (texts)");
        return Err(blame(word, Code::BAD_VALUE, text).into());
    }
    if kinds.len() != count {
        let text =
            format!("{} letters for {count} values (those given, and the one that comes back)", kinds.len());
        return Err(blame(word, Code::BAD_VALUE, text).into());
    }
    Ok(kinds)
}

impl Vars {
    /// From now on functions are those of this program.
    pub fn set_functions(&mut self, program: Arc<dyn Functions>) {
        self.program = Some(program);
    }

    /// The program that has functions.
    pub fn functions(&self) -> Option<&Arc<dyn Functions>> {
        self.program.as_ref()
    }

    /// Makes a function known.
    pub fn know(&mut self, name: String, function: Function) {
        let known: &mut BTreeMap<String, Function> = Arc::make_mut(&mut self.known);
        known.insert(name, function);
        self.event();
    }

    /// The variables that the function of a variable is given.
    pub(crate) fn inputs(&self, name: &str) -> impl Iterator<Item = &str> {
        let function = match self.find(name).map(|v| &v.data) {
            Some(Data::Python(function)) => self.known.get(function),
            _ => None,
        };
        let inputs = function.into_iter().flat_map(|f| &f.inputs);
        inputs.filter_map(|(input, _)| match input {
            Input::Variable(name) => Some(name.as_str()),
            Input::Word(_) => None,
        })
    }

    /// Calls a function that is known; `None` where what it is given is known to a run alone.
    ///
    /// # Errors
    /// No such function, values of other kinds, and what goes wrong in the function.
    pub fn invoke(&self, function: &str, span: Span, env: &mut dyn Env) -> Result<Option<Given>> {
        self.called(function, None, span, env, &mut Trail::default())
    }

    /// The same for a variable.
    pub(super) fn called(
        &self,
        function: &str,
        variable: Option<&str>,
        span: Span,
        env: &mut dyn Env,
        trail: &mut Trail,
    ) -> Result<Option<Given>> {
        let (Some(program), Some(known)) = (&self.program, self.known.get(function)) else {
            let text = format!("there is no function `{function}` yet");
            let d = Diagnostic::error(Code::UNKNOWN_NAME, span, text);
            return Err(d.help(format!("`python {function} …` makes it known before this line")).into());
        };
        if let Some(variable) = variable.filter(|own| known.gives.as_ref().is_none_or(|g| g.0 != *own)) {
            let text = format!("function `{function}` gives nothing to variable `{variable}`");
            let d = Diagnostic::error(Code::CONFLICT, span, text);
            return Err(d.help(format!("use `return v_{variable}` in its `python` line")).into());
        }
        if env.only_looks() {
            return Ok(None);
        }
        let mut given = vec![];
        for (input, kind) in &known.inputs {
            match self.given(input, *kind, span, env, trail)? {
                Some(value) => given.push(value),
                None => return Ok(None),
            }
        }
        self.event();
        let back = program
            .call(function, &given)
            .or_else(|words| fail(Code::OUTSIDE, span, format!("function `{function}` failed: {words}")))?;
        let kind = known.gives.as_ref().map(|g| g.1);
        let fits = matches!(
            (&back, kind),
            (_, None)
                | (Given::Whole(_), Some('i' | 'f'))
                | (Given::Real(_), Some('f'))
                | (Given::Text(_), Some('s'))
        );
        if !fits {
            let kind = kind.unwrap_or(' ');
            let text = format!("function `{function}` gave back {}, its format is `{kind}`", what(&back));
            return fail(Code::WRONG_KIND, span, text);
        }
        Ok(Some(back))
    }

    /// A value for a function.
    fn given(
        &self,
        input: &Input,
        kind: char,
        span: Span,
        env: &mut dyn Env,
        trail: &mut Trail,
    ) -> Result<Option<Given>> {
        let text = match input {
            Input::Word(word) => word.clone(),
            Input::Variable(name) if kind != 's' => {
                let r = ValueRef { kind: RefKind::Variable, name: name.clone(), index: vec![], span };
                return match self.reference(&r, env, trail)? {
                    Value::Number(a) if kind == 'f' => Ok(Some(Given::Real(a))),
                    Value::Number(a) => whole(a, name, span).map(Some),
                    Value::Unknown => Ok(None),
                    other => fail(Code::WRONG_KIND, span, format!("variable `{name}` is {}", other.kind())),
                };
            }
            Input::Variable(name) => {
                let text = self.text_below(name, "", span, env, trail)?;
                if text.unknown {
                    return Ok(None);
                }
                text.text
            }
        };
        if kind == 's' {
            return Ok(Some(Given::Text(text)));
        }
        let Some(a) = number::parse(&text) else {
            return fail(
                Code::BAD_NUMBER,
                span,
                format!("`{text}` is no number, as the function's format requires"),
            );
        };
        if kind == 'f' { Ok(Some(Given::Real(a))) } else { whole(a, &text, span).map(Some) }
    }
}

fn whole(a: f64, of: &str, span: Span) -> Result<Given> {
    if a.fract() == 0.0 && a.abs() < 9e15 {
        return Ok(Given::Whole(a as i64));
    }
    fail(Code::BAD_NUMBER, span, format!("`{of}` is {a}, and the function's format requires a whole number"))
}

fn what(given: &Given) -> &'static str {
    match given {
        Given::Whole(_) => "a whole number",
        Given::Real(_) => "a number",
        Given::Text(_) => "a text",
        Given::Nothing => "nothing",
    }
}
