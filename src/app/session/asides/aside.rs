//! A question whose answer takes long: asked by a key, answered on a thread of its own, kept until another key is
//! asked for. It can be given up, and what was given up is not begun again by itself.

use egui::Context;

use super::errand::{Errand, Watch};

/// What is known of one kind of question.
#[derive(Debug)]
pub struct Aside<K, T> {
    /// What the thread is called, and what a refusal of one names.
    name: &'static str,
    known: Option<(K, T)>,
    underway: Option<(K, Errand<T>)>,
    given_up: Option<K>,
}

impl<K: PartialEq + Clone, T: Send + 'static> Aside<K, T> {
    /// Nothing asked yet.
    pub fn new(name: &'static str) -> Self {
        Aside { name, known: None, underway: None, given_up: None }
    }

    /// Has `work` answer `key`, unless that is known, under way or given up. While another key is under way it waits
    /// its turn: ask again in the next frame. `work` is handed the last answer, to go on from. An error tells that there is no thread for it.
    pub fn want<W>(&mut self, key: &K, ctx: &Context, work: impl FnOnce(Option<(&K, &T)>) -> W) -> Result<(), String>
    where
        W: FnOnce(&Watch) -> Result<T, String> + Send + 'static,
    {
        if self.underway.is_some() || self.known(key).is_some() || self.is_given_up(key) {
            return Ok(());
        }
        match Errand::start(self.name, ctx, work(self.latest())) {
            Ok(errand) => {
                self.underway = Some((key.clone(), errand));
                Ok(())
            }
            Err(error) => {
                self.given_up = Some(key.clone());
                Err(format!("no thread for the {}: {error}", self.name))
            }
        }
    }

    /// Takes the answer in once it is there; a failure is told once, and is given up.
    pub fn hear(&mut self, ctx: &Context) -> Result<(), String> {
        let Some((key, errand)) = &self.underway else { return Ok(()) };
        let Some(answer) = errand.answer() else {
            ctx.request_repaint_after_secs(0.1);
            return Ok(());
        };
        let key = key.clone();
        self.underway = None;
        match answer {
            Ok(answer) => self.known = Some((key, answer)),
            Err(line) => {
                self.given_up = Some(key);
                return Err(line);
            }
        }
        Ok(())
    }

    /// The answer to `key`, once it is known.
    pub fn known(&self, key: &K) -> Option<&T> {
        self.known.as_ref().filter(|(known, _)| known == key).map(|(_, answer)| answer)
    }

    /// The last answer, with what was asked.
    pub fn latest(&self) -> Option<(&K, &T)> {
        self.known.as_ref().map(|(key, answer)| (key, answer))
    }

    /// Forgets all that is not about what `still` holds for; what is under way for it is called off.
    pub fn keep_only(&mut self, still: impl Fn(&K) -> bool) {
        self.known.take_if(|(key, _)| !still(key));
        self.underway.take_if(|(key, _)| !still(key));
        self.given_up.take_if(|key| !still(key));
    }

    /// Calls off what is under way.
    pub fn give_up(&mut self) {
        if let Some((key, _)) = self.underway.take() {
            self.given_up = Some(key);
        }
    }

    /// Lets what was given up be asked again.
    pub fn try_again(&mut self) {
        self.given_up = None;
    }

    /// Whether `key` was called off, or failed.
    pub fn is_given_up(&self, key: &K) -> bool {
        self.given_up.as_ref() == Some(key)
    }

    /// Whether an answer is being found.
    pub fn is_underway(&self) -> bool {
        self.underway.is_some()
    }

    /// The share done, 0 to 1, while an answer is being found.
    pub fn share(&self) -> Option<f64> {
        self.underway.as_ref().map(|(_, errand)| errand.share())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Waits until nothing is under way; what went wrong.
    fn settle(aside: &mut Aside<u32, u32>) -> Result<(), String> {
        let ctx = Context::default();
        for _ in 0..2000 {
            aside.hear(&ctx)?;
            if !aside.is_underway() {
                return Ok(());
            }
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        panic!("no answer");
    }

    #[test]
    fn an_answer_is_kept_for_its_key_and_handed_to_the_next_question() {
        let (ctx, mut aside) = (Context::default(), Aside::new("doubling"));
        aside.want(&3, &ctx, |_| |_: &Watch| Ok(6)).unwrap();
        settle(&mut aside).unwrap();
        assert_eq!((aside.known(&3), aside.known(&4)), (Some(&6), None));
        let more = |before: Option<(&u32, &u32)>| {
            let before = *before.unwrap().1;
            move |_: &Watch| Ok(before + 2)
        };
        aside.want(&4, &ctx, more).unwrap();
        settle(&mut aside).unwrap();
        assert_eq!(aside.latest(), Some((&4, &8)));
        aside.keep_only(|key| *key == 3);
        assert_eq!(aside.latest(), None);
    }

    #[test]
    fn what_fails_or_is_given_up_is_not_begun_again_until_told() {
        let (ctx, mut aside) = (Context::default(), Aside::new("failing"));
        aside.want(&1, &ctx, |_| |_: &Watch| Err("as told".to_owned())).unwrap();
        assert_eq!(settle(&mut aside), Err("as told".to_owned()));
        aside.want(&1, &ctx, |_| |_: &Watch| Ok(1)).unwrap();
        assert!(!aside.is_underway() && aside.is_given_up(&1));
        aside.try_again();
        aside.want(&1, &ctx, |_| |_: &Watch| Ok(1)).unwrap();
        aside.give_up();
        assert!(!aside.is_underway() && aside.is_given_up(&1) && !aside.is_given_up(&2));
    }
}
